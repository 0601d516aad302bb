"""A simulation on a page in the browser."""

import atexit
import secrets
import threading
import time
import weakref
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import Env
from gymnasium.vector import VectorEnv
from numpy.typing import ArrayLike, NDArray

from manyhands._core import World
from manyhands._core.render import Camera
from manyhands.arguments import whole_number
from manyhands.files import write_text
from manyhands.measures import rotate
from manyhands.viewer.batches import source_of_worlds
from manyhands.viewer.environments import EnvSource, source_of_environment
from manyhands.viewer.gate import Gate, is_loopback, quiet, serve
from manyhands.viewer.notebook import has_screen, is_notebook, page_in_cell
from manyhands.viewer.overlays import Overlays
from manyhands.viewer.panel import Panel
from manyhands.viewer.player import Frame, Player
from manyhands.viewer.sources import Push, SimulationSource, Source, WorldSource
from manyhands.viewer.stage import Stage

_BRAND = (38, 110, 160)
_PULL = 60.0  # [N/m]


class Viewer:
    """A page that shows a world or an environment, and lets people play with it.

    The page moves the simulation once somebody presses Play, unless a loop of the program's moves it and calls `sync`
    after each step. A browser that is slow, or closed, holds up neither.

    ```python
    world = manyhands.World.from_file("robot.urdf")
    viewer = manyhands.view(world)  # prints the page's address
    for _ in range(1000):
        world.step()
        viewer.sync()  # keeps real time, and waits while the page says Pause
    ```
    """

    def __init__(
        self,
        shown: Any,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        token: str | None = None,
        title: str = "",
        fps: float = 30.0,
        open_browser: bool | None = None,
        announce: bool = True,
    ) -> None:
        """shown: a `World`, or an environment of this package made by `gymnasium.make` or `gymnasium.make_vec`.

        host: the address to listen on. Any that is not this machine's own needs a token in the page's address: the one
        given, or one drawn at random. port: the first to try. fps: frames a second, at most. open_browser: whether this
        machine's browser opens the page; by default where there is a screen, except in notebooks, which show the page
        themselves. announce: whether the page's address is printed. Raises TypeError on things of another kind,
        ValueError on a rate or port that makes no sense.
        """
        if not 1 <= fps <= 120:
            raise ValueError(f"fps is {fps}; expected 1 to 120")
        whole_number("port", port, 0, 2**16 - 1)
        self.source = _source(shown, title)
        if token is None and not is_loopback(host):
            token = secrets.token_urlsafe(16)
        self._token = token
        self.server = serve(host, port, title or self.source.title, Gate(token))
        self.overlays = Overlays(self.server)
        self.stage = Stage(self.server, self._on_drag, self.source.drag_key)
        self.player = Player(self.source, self._draw, fps, lambda: bool(self.server.get_clients()))
        if isinstance(self.source, EnvSource):
            self.source.on_reset.append(lambda _: self.overlays.clear_trails())
        self.pull = _PULL
        """Force of a drag [N/m]."""
        self.on_draw: list[Callable[[], None]] = []
        """What else is drawn with each frame, in the page's thread."""
        self._parts: tuple[Any, ...] = ()
        self._grabbed: Push | None = None
        self._close_once = threading.Lock()
        gui = self.server.gui
        gui.configure_theme(control_width="medium", show_logo=False, show_share_button=False, brand_color=_BRAND)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(390)
        self._look()
        self.panel = Panel(self)
        self.player.start()
        _open.add(self)
        if announce:
            moved = f" (port {port} is taken)" if port not in (0, self.server.get_port()) else ""
            print(f"manyhands: {self.source.title} is on {self.url}{moved}", flush=True)
        if open_browser is None:
            open_browser = has_screen() and not is_notebook()
        if open_browser:  # some of them let whoever opens them wait
            threading.Thread(target=webbrowser.open, args=(self.url,), daemon=True).start()

    # ---- the page ------------------------------------------------------------------------------------------------

    @property
    def url(self) -> str:
        """The page's address, with the token if it takes one."""
        host = self.server.get_host()
        name = "localhost" if host in ("0.0.0.0", "::", "127.0.0.1") else f"[{host}]" if ":" in host else host
        return f"http://{name}:{self.server.get_port()}/" + (f"?token={self._token}" if self._token else "")

    @property
    def is_closed(self) -> bool:
        """Whether `close` was called, or the page's server has ended."""
        return self.player.is_closed

    def close(self) -> None:
        """Takes the page away; may be called again."""
        with self._close_once:
            if self.player.is_closed:
                return
            self.panel.close()
            self.player.close()
            with quiet():
                self.server.stop()

    def wait(self) -> None:
        """Until the viewer is closed or somebody presses Ctrl-C."""
        try:
            while not self.is_closed:
                time.sleep(0.2)
        except KeyboardInterrupt:
            self.close()

    def __enter__(self) -> "Viewer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        """What a notebook shows of it: the page."""
        return page_in_cell(self.url)

    # ---- time ----------------------------------------------------------------------------------------------------

    def play(self) -> None:
        """Lets time pass."""
        self.player.problem = ""
        self.player.playing = True

    def pause(self) -> None:
        """Stops time; a loop that calls `sync` waits."""
        self.player.playing = False

    def step(self, n: int = 1) -> None:
        """Pauses, and steps n times."""
        self.player.step(n)

    def reset(self) -> None:
        """Begins anew: a world where the page found it, an environment with another episode."""
        self.player.restart()
        self.player.do(self.overlays.clear_trails)

    def rewind(self, seconds: float) -> None:
        """Pauses so many simulated seconds ago, at most three minutes; `play` goes on from there."""
        self.player.rewind(self.player.history.span[1] - seconds)

    @property
    def speed(self) -> float:
        """Simulated seconds in a second; infinite: as fast as it goes."""
        return self.player.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        if not speed > 0:
            raise ValueError(f"speed is {speed}; expected more than 0")
        self.player.speed = speed

    def sync(self) -> None:
        """To be called after each step of a loop that moves the simulation: keeps the page's pace, and waits while it
        is paused. Never waits for a browser."""
        self.player.sync()

    # ---- drawing -------------------------------------------------------------------------------------------------

    def line(
        self, name: str, points: ArrayLike, *, color: tuple[int, int, int] = (220, 60, 60), width: float = 3.0
    ) -> None:
        """A line through points (n, 3) [m], some pixels wide; replaces what was drawn under that name."""
        self.overlays.line(name, points, color, width)

    def text(self, name: str, text: str, position: ArrayLike) -> None:
        """A label at a place (3) [m]."""
        self.overlays.text(name, text, position)

    def axes(
        self, name: str, position: ArrayLike, quaternion: ArrayLike = (0.0, 0.0, 0.0, 1.0), *, size: float = 0.1
    ) -> None:
        """The axes of a frame at a pose (3), xyzw (4): x red, y green, z blue."""
        self.overlays.axes(name, position, quaternion, size)

    def look(self, position: ArrayLike, look_at: ArrayLike) -> None:
        """Puts the camera of every browser at a position (3) [m], turned to another."""
        at, to = np.asarray(position, np.float64), np.asarray(look_at, np.float64)
        camera = self.server.initial_camera
        camera.position, camera.look_at, camera.up = at, to, np.array([0.0, 0.0, 1.0])
        for client in self.server.get_clients().values():
            with client.atomic():
                client.camera.position, client.camera.look_at = at, to

    def trail(self, link: str) -> None:
        """Draws where a link goes. Raises KeyError on an unknown one."""
        self.source.model.link(link)
        self.overlays.add_trail(link)

    def erase(self, name: str) -> None:
        """Takes away what was drawn under a name; passes over unknown ones."""
        self.overlays.remove(name)

    def plot(self, name: str, measure: Callable[[], ArrayLike]) -> None:
        """Offers a quantity among the page's plots: what gives a number or an array (k), asked at most `fps` times a
        second between two steps."""
        self.panel.graphs.add(name, measure)

    def actor(self, name: str, act: Callable[[Any], ArrayLike]) -> None:
        """Lets a policy act in the environment that is shown: what gives an action for an observation. The page offers
        it by that name. Raises TypeError where there is no environment."""
        if self.panel.teleop is None:
            raise TypeError(f"{self.source.title} is no environment in which {name!r} could act")
        self.panel.teleop.add(name, act)

    def camera(self, name: str, camera: Camera | Callable[[], NDArray[np.uint8] | None]) -> None:
        """Offers what a camera sees beside the scene, or pictures (h, w, 3) from elsewhere; they are taken a few times
        a second, while they are looked at. Raises TypeError where only poses are known."""
        if self.panel.cameras is None:
            raise TypeError(f"{self.source.title} is only watched: no camera {name!r} can be offered")
        self.panel.cameras.add(name, camera)

    # ---- keeping -------------------------------------------------------------------------------------------------

    def save_html(self, path: str | Path, seconds: float | None = None) -> Path:
        """Writes what the page showed in the last seconds, at most three minutes, as a page that opens alone."""
        path = Path(path)
        write_text(path, self.recording(seconds))
        return path

    def recording(self, seconds: float | None = None) -> str:
        """The last seconds, all that are remembered without a number, as the text of a page that opens alone."""
        return self.panel.recorder.html(seconds)

    def picture(self, width: int = 1280, height: int = 800) -> NDArray[np.uint8]:
        """What the page shows, (height, width, 3), drawn by a browser that has it open. Raises RuntimeError if there is
        none."""
        clients = list(self.server.get_clients().values())
        if not clients:
            raise RuntimeError(f"no browser has the page open: {self.url}")
        return clients[0].get_render(height, width, transport_format="png", timeout=30.0)[..., :3]

    # ---- inside --------------------------------------------------------------------------------------------------

    def _look(self) -> None:
        """Builds the scene and puts the camera before it."""
        self._parts = self.source.parts()
        if self.source.background is not None:
            self.stage.set_background(self.source.background)
        self.stage.build(self.source.model, *self.source.poses())
        self.server.initial_camera.fov = np.radians(38.0)
        self.look(*self.stage.camera())

    def _draw(self, frame: Frame) -> None:
        """In the player's thread."""
        with self.server.atomic():
            if frame.parts != self._parts:
                self._parts = frame.parts
                self.player.do(self._rebuild)
                return
            self.stage.show(frame.positions, frame.quaternions)
            self.stage.show_markers(frame.markers)
            self.stage.neighbours.show(frame.neighbours)
            self.overlays.show_contacts(frame.contacts)
            links = {link: frame.positions[self.stage.index[link]] for link in self.overlays.trails}
            self.overlays.extend_trails(links)
            self._draw_push(frame)
            for draw in self.on_draw:
                draw()
        self.panel.update(frame)

    def _rebuild(self) -> None:
        """After bodies came or went: states from before are of no use."""
        self.player.history.clear()
        self.stage.build(self.source.model, *self.source.poses())
        self.panel.rebuild()

    def _draw_push(self, frame: Frame) -> None:
        push = self._grabbed
        if push is None or push.link not in self.stage.index:
            self.overlays.show_push(None, None)
            return
        index = self.stage.index[push.link]
        point = frame.positions[index] + rotate(frame.quaternions[index], push.point)
        self.overlays.show_push(point, push.force)

    def _on_drag(self, link: str, event: Any) -> None:
        """A body is pulled by the mouse, in viser's thread."""
        if not self.source.can_be_pulled:
            return
        key = event.client_id
        if event.phase == "end":
            self._grabbed = None
            self.player.do(lambda: self.source.pushes.pop(key, None) and None)
            return
        start, end = np.array(event.start_position), np.array(event.end_position)
        force = self.pull * (end - start)

        def pull() -> None:
            if all(each.name != link for each in self.source.model.links):
                return  # it has just been taken away
            held = self.source.pushes.get(key)
            point = held.point if held is not None else self.source.local(link, start)
            self._grabbed = self.source.pushes[key] = Push(link, point, force, end)

        self.player.do(pull)


_open: "weakref.WeakSet[Viewer]" = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """A thread that outlives the interpreter would keep worlds alive."""
    for viewer in list(_open):
        viewer.close()


def _source(shown: Any, title: str) -> Source:
    if isinstance(shown, Source):
        return shown
    if isinstance(shown, World):
        return WorldSource(shown, title)
    if isinstance(shown, Env) and isinstance(world := getattr(shown.unwrapped, "world", None), World):
        return WorldSource(
            world, title or (shown.spec.id if shown.spec is not None else type(shown.unwrapped).__name__)
        )
    if isinstance(getattr(shown, "world", None), World):
        return SimulationSource(shown, title or "simulation")
    if isinstance(shown, VectorEnv):
        return source_of_worlds(shown, title)
    source = source_of_environment(shown, title)
    if source is None:
        raise TypeError(f"there is no way to show a {type(shown).__name__}: expected a World or an environment")
    return source
