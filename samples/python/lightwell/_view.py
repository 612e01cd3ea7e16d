"""Views: one viewport each (an eye, a monitor), what may be planned for it, and what may be wrong with its inputs."""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, List, Literal, Optional, Tuple, Union, overload

from ._arguments import real, whole
from ._enums import InputFault, Severity
from ._errors import check
from ._frame import Frame, GBuffer, frame_struct, gbuffer_struct, new_struct
from ._handles import Handle
from ._images import Array, Kept, empty_image, fill_image
from ._library import NULL, ffi, lib, text

if TYPE_CHECKING:
    from ._device import Device


@dataclasses.dataclass(frozen=True)
class Probes:
    """What planning measured of a frame; NaN where there was nothing to measure it by."""

    indirect_share: float
    flux_on_screen: float
    flux_concentration: float
    depth_complexity: float
    extent: float
    albedo: float
    facing: float
    hidden: float


@dataclasses.dataclass(frozen=True)
class Plan:
    """What to run and what to expect: `device.technique_from_text(plan.technique, plan.parameters)`. Errors are relMSE against all
    bounces; `confidence`: the chance that the true error is within a factor of two."""

    technique: str
    parameters: str
    reason: str
    predicted_ms: float
    predicted_error: float
    confidence: float
    within_budget: bool
    reaches_error: bool
    probes: Probes
    coverage: float


@dataclasses.dataclass(frozen=True)
class Finding:
    """One thing that is wrong with inputs: what was found, its likely cause and the cure stand in `message`."""

    fault: InputFault
    severity: Severity
    argument: str
    message: str
    affected: int
    examined: int
    measured: float
    expected: float
    confidence: float
    colour: Tuple[float, float, float]


def _plan(struct: Any) -> Plan:
    p = struct.probes
    probes = Probes(p.indirectShare, p.fluxOnScreen, p.fluxConcentration, p.depthComplexity, p.extent, p.albedo, p.facing, p.hidden)
    return Plan(text(struct.technique), text(struct.parameters), text(struct.reason), struct.predictedMs, struct.predictedError,
                struct.confidence, bool(struct.withinBudget), bool(struct.reachesError), probes, struct.coverage)


def _finding(struct: Any) -> Finding:
    return Finding(InputFault(struct.fault), Severity(struct.severity), text(struct.argument), text(struct.message), struct.affected,
                   struct.examined, struct.measured, struct.expected, struct.confidence,
                   (struct.colour[0], struct.colour[1], struct.colour[2]))


def input_faults() -> List[Tuple[InputFault, str, str]]:
    """All that `View.check_inputs` can find: fault, name, one line."""
    faults = []
    for index in range(lib.lwCountInputFaults()):
        struct = new_struct("LWInputFaultInfo")
        check(lib.lwDescribeInputFault(index, struct))
        faults.append((InputFault(struct.fault), text(struct.name), text(struct.summary)))
    return faults


class View(Handle):
    """A viewport of `width` x `height` pixels at most; `resize` changes its size without allocating."""

    _what = "view"

    def __init__(self, device: "Device", width: int, height: int) -> None:
        self.device = device
        desc = new_struct("LWViewDesc")
        desc.maxWidth, desc.maxHeight = whole(width, "width"), whole(height, "height")
        handle = ffi.new("LWView*")
        check(lib.lwCreateView(device.handle, desc, handle), device.handle)
        super().__init__(handle[0], lib.lwReleaseView, device.log_callback)

    @property
    def size(self) -> Tuple[int, int]:
        """Width and height now."""
        sides = ffi.new("uint32_t[2]")
        check(lib.lwGetViewSize(self.handle, sides, sides + 1), self.device.handle)
        return sides[0], sides[1]

    def resize(self, width: int, height: int) -> None:
        """Dynamic resolution: any size up to the first."""
        check(lib.lwSetViewSize(self.handle, whole(width, "width", 1), whole(height, "height", 1)), self.device.handle)

    def plan(self, frame: Frame, gbuffer: GBuffer, *, budget_ms: float = 0.0, error_target: float = 0.0, views: int = 1,
             at_rest: bool = False) -> Plan:
        """The technique and settings for this frame: the cheapest that is predicted to reach `error_target`, else the most accurate
        within `budget_ms`. `at_rest`: of frames whose light and geometry stand still, all maps having a version. The first call on a
        device calibrates it, for up to two seconds."""
        frame_, gbuffer_, desc, _kept = self._plan_arguments(frame, gbuffer, budget_ms, error_target, views, at_rest)
        struct = new_struct("LWPlan")
        check(lib.lwPlan(self.handle, frame_, gbuffer_, desc, struct), self.device.handle)
        return _plan(struct)

    def plans(self, frame: Frame, gbuffer: GBuffer, *, budget_ms: float = 0.0, error_target: float = 0.0, views: int = 1,
              at_rest: bool = False) -> List[Plan]:
        """All that `plan` chooses from, quickest first."""
        frame_, gbuffer_, desc, _kept = self._plan_arguments(frame, gbuffer, budget_ms, error_target, views, at_rest)
        count = ffi.new("uint32_t*")
        check(lib.lwListPlans(self.handle, frame_, gbuffer_, desc, NULL, 0, count), self.device.handle)
        capacity = count[0]
        structs = ffi.new("LWPlan[]", capacity)
        for index in range(capacity):
            structs[index].structSize = ffi.sizeof("LWPlan")
        check(lib.lwListPlans(self.handle, frame_, gbuffer_, desc, structs, capacity, count), self.device.handle)
        return [_plan(structs[index]) for index in range(min(count[0], capacity))]

    def _plan_arguments(self, frame: Frame, gbuffer: GBuffer, budget_ms: float, error_target: float, views: int, at_rest: bool) -> Tuple[Any, ...]:
        self.device.handle  # closed: refused
        kept = Kept()
        desc = new_struct("LWPlanDesc", kept)
        desc.budgetMs, desc.errorTarget = real(budget_ms, "budget_ms"), real(error_target, "error_target")
        desc.views = whole(views, "views")
        desc.atRest = bool(at_rest)
        return frame_struct(frame, kept), gbuffer_struct(gbuffer, kept), desc, kept

    @overload
    def check_inputs(self, frame: Optional[Frame] = ..., gbuffer: Optional[GBuffer] = ..., *,
                     overlay: Literal[False] = ...) -> List[Finding]: ...

    @overload
    def check_inputs(self, frame: Optional[Frame] = ..., gbuffer: Optional[GBuffer] = ..., *,
                     overlay: Union[Literal[True], Array]) -> Tuple[List[Finding], Array]: ...

    def check_inputs(self, frame: Optional[Frame] = None, gbuffer: Optional[GBuffer] = None, *,
                     overlay: Union[bool, Array] = False) -> Union[List[Finding], Tuple[List[Finding], Array]]:
        """What is wrong with a frame's inputs, the most severe first; a debugging aid that reads all images back. With `overlay` also
        a picture (height, width, 3) of the G-buffer in grey, affected pixels in their finding's colour."""
        kept = Kept()
        width, height = self.size
        frame_ = frame_struct(frame, kept) if frame is not None else NULL
        gbuffer_ = gbuffer_struct(gbuffer, kept) if gbuffer is not None else NULL
        picture, image = None, NULL
        if overlay is not False:
            picture = empty_image(height, width, 3) if overlay is True else overlay
            image = kept.add(ffi.new("LWImage*"))
            fill_image(image, picture, "overlay", kept, written=True)
        capacity, count = 64, ffi.new("uint32_t*")
        while True:
            structs = ffi.new("LWInputFinding[]", capacity)
            check(lib.lwCheckInputs(self.handle, frame_, gbuffer_, structs, capacity, count, image), self.device.handle)
            if count[0] <= capacity:
                break
            capacity = count[0]
        findings = [_finding(structs[index]) for index in range(count[0])]
        return findings if picture is None else (findings, picture)
