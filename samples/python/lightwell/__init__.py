"""Lightwell: indirect light for pictures already lit directly, from NumPy arrays and into them. docs/python.md tells how.

    with lightwell.Device() as device:
        view, technique = device.view(width, height), device.technique("rsm", vpls=512)
        technique.update(lightwell.Frame(lights=[sun]))                    # once per frame
        irradiance = technique.render(view, gbuffer).irradiance            # once per view: W/m^2
        picture = direct + albedo / numpy.pi * irradiance
"""
from ._camera import Camera, look_at, orthographic, perspective
from ._device import Device, DeviceInfo, Roofline, devices
from ._enums import DepthKind, Format, InputFault, LightKind, LogLevel, ParameterKind, Receivers, Severity, Status
from ._errors import (BuildError, DeviceError, Error, InvalidArgumentError, InvalidHandleError, NoDeviceError, NotUpdatedError,
                      OutOfMemoryError, ReentrantError, UnsupportedError)
from ._frame import Frame, GBuffer, Geometry, Light, Rsm
from ._images import Image, empty_image
from ._library import __version__
from ._records import blockers, static_vpls, vpls
from ._settings import Parameter, TechniqueInfo, describe_techniques
from ._technique import DebugView, Output, PointOutput, Technique
from ._view import Finding, Plan, Probes, View, input_faults

__all__ = [
    "BuildError", "Camera", "DebugView", "DepthKind", "Device", "DeviceError", "DeviceInfo", "Error", "Finding", "Format", "Frame",
    "GBuffer", "Geometry", "Image", "InputFault", "InvalidArgumentError", "InvalidHandleError", "Light", "LightKind", "LogLevel",
    "NoDeviceError", "NotUpdatedError", "OutOfMemoryError", "Output", "Parameter", "ParameterKind", "Plan", "PointOutput", "Probes",
    "Receivers", "ReentrantError", "Roofline", "Rsm", "Severity", "Status", "Technique", "TechniqueInfo", "UnsupportedError", "View",
    "__version__", "blockers", "describe_techniques", "devices", "empty_image", "input_faults", "look_at", "orthographic",
    "perspective", "static_vpls", "vpls",
]
