"""What stands in, on both sides alike, for a window and for somebody who sits before it.

Every function of `pybullet` is replaced by one that counts and passes on. A few do more: connections with a window
have none, sliders keep the values they start with, the window's camera is computed, and where real-time simulation is
on, the steps that are due are made at the next call.
"""

import builtins
import inspect
import math
import time
from collections import Counter
from collections.abc import Callable
from multiprocessing import RawArray
from typing import Any

WIDTH, HEIGHT = 1024, 768
DUE_STEPS = 16  # at most, of real time, at one call
SAMPLES = [4**k * 16 for k in range(8)]
"""Numbers of steps after which the bodies are looked at, so that both sides are at the same ones."""


class Headless:
    """What was called, and what takes the window's place."""

    def __init__(self, module: Any) -> None:
        self.module = module
        self.original = {name: value for name, value in vars(module).items() if inspect.isbuiltin(value)}
        self.called: Counter[str] = Counter()
        self.totals = RawArray("L", 2)  # calls and steps, those of child processes included
        self.sliders: list[float] = []
        self.camera = (5.0, 50.0, -35.0, (0.0, 0.0, 0.0))
        self.clocks: dict[int, float] = {}
        self.looks: dict[int, dict[str, Any]] = {}

    def install(self) -> None:
        """Takes the places of the module's functions, of `input` and of `time.sleep`."""
        for name in self.original:
            setattr(self.module, name, self._counted(name, getattr(self, name, self.original[name])))
        is_builtin = inspect.isbuiltin
        inspect.isbuiltin = lambda thing: is_builtin(thing) or hasattr(thing, "stands_for_pybullet")
        time.sleep = lambda _: None
        builtins.input = lambda *_: ""

    def _counted(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*arguments: Any, **named: Any) -> Any:
            self.called[name] += 1
            self.totals[0] += 1
            result = function(*arguments, **named)
            if self.clocks:
                self._catch_up()
            return result

        counted.stands_for_pybullet = True  # pyright: ignore[reportFunctionMemberAccess]
        counted.__name__ = name
        return counted

    def _catch_up(self) -> None:
        """Makes the steps of real time."""
        now = time.perf_counter()
        for client, last in list(self.clocks.items()):
            if not self.original["isConnected"](client):
                del self.clocks[client]
                continue
            step = self.original["getPhysicsEngineParameters"](physicsClientId=client)["fixedTimeStep"]
            due = int((now - last) / step) if step > 0 else 0
            if due:
                self.clocks[client] = now
            for _ in range(min(due, DUE_STEPS)):
                self.stepSimulation(physicsClientId=client)

    def connect(self, method: int, *arguments: Any, **named: Any) -> int:
        """Without a window; servers with a window are taken for such connections, too."""
        p = self.module
        windows = (p.GUI, p.GUI_SERVER, p.GUI_MAIN_THREAD, p.SHARED_MEMORY_GUI, p.SHARED_MEMORY_SERVER)
        return self.original["connect"](p.DIRECT if method in windows else method, *arguments, **named)

    def stepSimulation(self, *arguments: Any, **named: Any) -> Any:  # noqa: N802
        """A step, and from time to time a look."""
        result = self.original["stepSimulation"](*arguments, **named)
        self.totals[1] += 1
        if self.totals[1] in SAMPLES:
            self.looks[self.totals[1]] = self.look()
        return result

    def setRealTimeSimulation(self, *arguments: Any, **named: Any) -> Any:  # noqa: N802
        """Starts or stops a client's clock."""
        result = self.original["setRealTimeSimulation"](*arguments, **named)
        values = dict(zip(("enableRealTimeSimulation", "physicsClientId"), arguments, strict=False)) | named
        client = values.get("physicsClientId", 0)
        if values.get("enableRealTimeSimulation"):
            self.clocks.setdefault(client, time.perf_counter())
        else:
            self.clocks.pop(client, None)
        return result

    def addUserDebugParameter(self, *arguments: Any, **named: Any) -> int:  # noqa: N802
        """A slider that stays where it starts."""
        item = self.original["addUserDebugParameter"](*arguments, **named)
        if item >= 0:
            return item
        values = dict(zip(("paramName", "rangeMin", "rangeMax", "startValue"), arguments, strict=False)) | named
        self.sliders.append(float(values.get("startValue", 0.0)))
        return len(self.sliders) - 1

    def readUserDebugParameter(self, *arguments: Any, **named: Any) -> float:  # noqa: N802
        """Where the slider stands."""
        try:
            return self.original["readUserDebugParameter"](*arguments, **named)
        except self.module.error:
            return self.sliders[named.get("itemUniqueId", arguments[0] if arguments else -1)]

    def resetDebugVisualizerCamera(self, *arguments: Any, **named: Any) -> Any:  # noqa: N802
        """Remembers where the window's camera would be."""
        result = self.original["resetDebugVisualizerCamera"](*arguments, **named)
        names = ("cameraDistance", "cameraYaw", "cameraPitch", "cameraTargetPosition")
        values = dict(zip(names, arguments, strict=False)) | named
        self.camera = (values[names[0]], values[names[1]], values[names[2]], tuple(values[names[3]]))
        return result

    def getDebugVisualizerCamera(self, *arguments: Any, **named: Any) -> tuple[Any, ...]:  # noqa: N802
        """What the window's camera would say."""
        told = self.original["getDebugVisualizerCamera"](*arguments, **named)
        if told[0] > 0:
            return told
        distance, yaw, pitch, target = self.camera
        view = self.original["computeViewMatrixFromYawPitchRoll"](target, distance, yaw, pitch, 0, 2)
        projection = self.original["computeProjectionMatrixFOV"](60, WIDTH / HEIGHT, 0.01, 1000)
        right, up, back = ([view[4 * k + row] for k in range(3)] for row in range(3))
        reach = 2 * 10000 * math.tan(math.radians(30))
        horizontal = tuple(reach * WIDTH / HEIGHT * x for x in right)
        forward = tuple(-x for x in back)
        vertical = tuple(reach * x for x in up)
        return (WIDTH, HEIGHT, view, projection, (0.0, 0.0, 1.0), forward, horizontal, vertical, yaw, pitch, distance,
                target)  # fmt: skip

    def look(self) -> dict[str, Any]:
        """How many bodies there are, whether all their numbers are finite, and how far from the origin they are [m]."""
        numbers: list[float] = []
        bodies = 0
        for client in range(16):
            if not self.original["isConnected"](client):
                continue
            for k in range(self.original["getNumBodies"](physicsClientId=client)):
                body = self.original["getBodyUniqueId"](k, physicsClientId=client)
                pose = self.original["getBasePositionAndOrientation"](body, physicsClientId=client)
                bodies += 1
                numbers += pose[0]
        finite = all(map(math.isfinite, numbers))
        return {"bodies": bodies, "finite": finite, "reach": max(map(abs, numbers), default=0.0) if finite else None}
