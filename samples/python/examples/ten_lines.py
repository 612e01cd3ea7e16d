import matplotlib.pyplot, numpy, lightwell
n, zero, one = 128, numpy.zeros((128, 128), "f4"), numpy.ones((128, 128), "f4")
u, v = numpy.meshgrid(*2 * [(numpy.arange(n, dtype="f4") + 0.5) / n])  # of pixels and texels: 0 .. 1
camera = lightwell.Camera(lightwell.look_at((2, 0.5, 0.5), (0, 0.5, 0.5)), lightwell.orthographic(1, 1, 0, 4))
wall = lightwell.Rsm(position=numpy.dstack([zero, 1 - v, 1 - u]), normal=numpy.dstack([one, zero, zero]),
                     flux=numpy.dstack([one, 0.6 * one, (u > 0.5) * one]) / n**2, camera=camera)  # W a texel
sun = lightwell.Light.directional((-1, 0, 0), (1, 1, 1), rsms=[wall])
floor = lightwell.GBuffer(position=numpy.dstack([u, zero, v]), normal=numpy.dstack([zero, one, zero]))
with lightwell.Device() as device, device.technique("rsm", vpls=0, interleave=1) as technique:
    technique.update(lightwell.Frame(lights=[sun]))
    irradiance = technique.render(device.view(n, n), floor).irradiance  # W/m^2
matplotlib.pyplot.imsave("floor.png", (2 * irradiance).clip(0, 1) ** (1 / 2.2))
