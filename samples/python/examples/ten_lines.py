import matplotlib.pyplot, numpy as np, lightwell as lw
u, v = np.meshgrid(*2 * [(np.arange(128, dtype="f4") + 0.5) / 128])  # of pixels and texels, 0 .. 1
picture = lambda *channels: np.dstack(np.broadcast_arrays(*channels, u)[:-1]).astype("f4")
camera = lw.Camera(lw.look_at((2, 0.5, 0.5), (0, 0.5, 0.5)), lw.orthographic(1, 1, 0, 4))
wall = lw.Rsm(position=picture(0, 1 - v, 1 - u), normal=picture(1, 0, 0), flux=picture(1, 0.6, u > 0.5) / 128**2, camera=camera)  # W
with lw.Device() as device, device.technique("rsm", vpls=0, interleave=1) as technique:
    technique.update(lw.Frame(lights=[lw.Light.directional((-1, 0, 0), (1, 1, 1), rsms=[wall])]))
    floor = lw.GBuffer(position=picture(u, 0, v), normal=picture(0, 1, 0))
    irradiance = technique.render(device.view(128, 128), floor).irradiance  # W/m^2
matplotlib.pyplot.imsave("floor.png", (2 * irradiance).clip(0, 1) ** (1 / 2.2))
