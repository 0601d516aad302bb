// manyhands._core.pybullet_gui: what the page of a client with a window, and tests in its place, see and do.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <numbers>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"
#include "bindings/vectors.h"
#include "manyhands/bullet/screen_frame.h"
#include "manyhands/physics/dynamics/checks.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bullet::DebugItem;
using bullet::Screen;
using bullet::ScreenFrame;
using pybullet::ClientLock;
using Numbers = std::array<double, 3>;

Numbers numbers(const Vec3<double>& a) { return {a.x, a.y, a.z}; }
Vec3<double> vector(const Numbers& a) { return {a[0], a[1], a[2]}; }
bool all_finite(const Numbers& a) { return internal::all_finite(a.data(), 3); }

/// The screen of a client, as long as it is locked.
Screen& screen_of(const ClientLock& client) {
  Screen* const screen = (*client).screen();
  if (screen == nullptr) throw bullet::Error("the client has no window: it was connected with DIRECT");
  return *screen;
}

nb::object rows(const std::vector<Vec3<double>>& all) {
  static_assert(sizeof(Vec3<double>) == 3 * sizeof(double));
  return bindings::copied(reinterpret_cast<const double*>(all.data()), {all.size(), 3});
}

/// From where a camera on an orbit looks.
Vec3<double> eye_of(const Screen& screen) {
  return screen.camera.target - screen.camera.distance * pybullet::screen_matrices(screen).forward;
}

/// The orbit of a camera at a place. Straight up and down, what it was turned to before stays.
Screen::Orbit orbit_of(const Vec3<double>& eye, const Vec3<double>& target, double yaw) {
  constexpr double kDegrees = 180 / std::numbers::pi, kUpright = 1e-9;
  const Vec3<double> ahead = target - eye;
  const double level = std::hypot(ahead.x, ahead.y);
  return {.distance = norm(ahead),
          .yaw = level > kUpright ? kDegrees * std::atan2(-ahead.x, ahead.y) : yaw,
          .pitch = kDegrees * std::atan2(ahead.z, level),
          .target = target};
}

void set_camera(int client, const Numbers& eye, const Numbers& target, int moves) {
  constexpr double kSame = 1e-4;  // [m]: what was set in degrees comes back from a browser with other last digits
  const ClientLock lock(client);
  Screen& screen = screen_of(lock);
  if (screen.camera_moves != moves || !all_finite(eye) || !all_finite(target)) return;
  const Vec3<double> at = vector(eye), to = vector(target);
  if (norm(at - eye_of(screen)) + norm(to - screen.camera.target) > kSame) {
    screen.camera = orbit_of(at, to, screen.camera.yaw);
  }
}

void bind_items(nb::module_& m) {
  nb::class_<DebugItem>(m, "DebugItem", "A line, a text, points or a parameter.")
      .def_prop_ro(
          "kind", [](const DebugItem& i) { return std::array{"line", "text", "points", "parameter"}[i.kind]; },
          nb::sig("def kind(self) -> str"), "'line', 'text', 'points' or 'parameter'.")
      .def_ro("text", &DebugItem::text, "Of a text; the name of a parameter.")
      .def_prop_ro(
          "points", [](const DebugItem& i) { return rows(i.points); },
          nb::sig("def points(self) -> numpy.typing.NDArray[numpy.float64]"), "(n, 3) in the world [m].")
      .def_prop_ro(
          "colours", [](const DebugItem& i) { return rows(i.colours); },
          nb::sig("def colours(self) -> numpy.typing.NDArray[numpy.float64]"), "(n, 3), one for all or for each point.")
      .def_ro("size", &DebugItem::size, "Width of a line, size of points and texts.")
      .def_ro("low", &DebugItem::low)
      .def_ro("high", &DebugItem::high, "Of a slider; less than low: of a button.")
      .def_ro("value", &DebugItem::value)
      .def_ro("serial", &DebugItem::serial, "Of the change that made it.");
}

void bind_frame(nb::module_& m) {
  static const std::string array = "(self) -> numpy.typing.NDArray[numpy.float64]";
  static const std::string q = "def q" + array, positions = "def positions" + array,
                           quaternions = "def quaternions" + array;
  nb::class_<ScreenFrame>(m, "ScreenFrame", "What a client shows at one moment.")
      .def_ro("scene", &ScreenFrame::scene, "Changes when bodies come, go or are built anew.")
      .def_ro("time", &ScreenFrame::time, "[s]")
      .def_prop_ro(
          "q", [](const ScreenFrame& f) { return bindings::copied(f.q.data(), {f.q.size()}); }, nb::sig(q.c_str()),
          "(nq)")
      .def_prop_ro(
          "positions", [](const ScreenFrame& f) { return rows(f.positions); }, nb::sig(positions.c_str()),
          "Of the links (n, 3) [m].")
      .def_prop_ro(
          "quaternions",
          [](const ScreenFrame& f) {
            static_assert(sizeof(Quat<double>) == 4 * sizeof(double));
            return bindings::copied(reinterpret_cast<const double*>(f.quaternions.data()), {f.quaternions.size(), 4});
          },
          nb::sig(quaternions.c_str()), "Of the links (n, 4), xyzw.")
      .def_prop_ro(
          "model", [](const ScreenFrame& f) { return f.model ? std::make_unique<PythonModel>(f.model) : nullptr; },
          nb::sig("def model(self) -> manyhands._core.Model | None"), "A copy, if it was asked for.")
      .def_ro("looks", &ScreenFrame::looks, "Grows with changes of colours.")
      .def_prop_ro(
          "rgba", [](const ScreenFrame& f) { return bindings::copied(f.rgba.data()->data(), {f.rgba.size(), 4}); },
          nb::sig("def rgba(self) -> numpy.typing.NDArray[numpy.float32]"),
          "Of the model's geoms (n, 4); (0, 4) if no colour has changed.")
      .def_ro("serial", &ScreenFrame::serial, "Grows with changes of items.")
      .def_ro("ids", &ScreenFrame::ids, "Of all items.")
      .def_ro("items", &ScreenFrame::items, "By ids, those that have changed or move.")
      .def_prop_ro(
          "switches", [](const ScreenFrame& f) { return f.screen.switches; }, "Of configureDebugVisualizer, by flags.")
      .def_prop_ro(
          "background",
          [](const ScreenFrame& f) {
            return f.screen.background ? nb::cast(numbers(*f.screen.background)) : nb::none();
          },
          nb::sig("def background(self) -> list[float] | None"), "Its colour (3), if it is not the viewer's own.")
      .def_prop_ro(
          "camera_moves", [](const ScreenFrame& f) { return f.screen.camera_moves; },
          "Grows with resetDebugVisualizerCamera.")
      .def_prop_ro(
          "eye", [](const ScreenFrame& f) { return numbers(eye_of(f.screen)); }, "Of the camera (3) [m].")
      .def_prop_ro(
          "target", [](const ScreenFrame& f) { return numbers(f.screen.camera.target); }, "Of the camera (3) [m].")
      .def_prop_ro(
          "listens_to_keys", [](const ScreenFrame& f) { return f.screen.listens_to_keys; },
          "Whether the program has asked for events of keys.")
      .def_prop_ro(
          "listens_to_mouse", [](const ScreenFrame& f) { return f.screen.listens_to_mouse; },
          "Whether the program has asked for events of the mouse.");
}

void bind_people(nb::module_& m) {
  m.def(
      "diagnose", [](int client) { return (*ClientLock(client)).world().diagnose(); }, "client"_a = 0,
      "What commonly goes wrong with a client's world: see `World.diagnose`.");
  m.def(
      "set_parameter",
      [](int client, int item, double value) {
        const ClientLock lock(client);
        if (!screen_of(lock).set_parameter(item, value)) {
          throw bullet::Error("there is no slider or button " + std::to_string(item));
        }
      },
      "client"_a, "item"_a, "value"_a,
      "Moves a slider, within its range, or tells how often a button was pressed, as people do on the page.");
  m.def(
      "press_key",
      [](int client, int key, bool down) {
        const ClientLock lock(client);
        screen_of(lock).press(key, down);
      },
      "client"_a, "key"_a, "down"_a = true, "Presses a key of PyBullet's code, or lets it go.");
  m.def(
      "move_mouse",
      [](int client, double x, double y) {
        const ClientLock lock(client);
        screen_of(lock).move_mouse(x, y);
      },
      "client"_a, "x"_a, "y"_a, "Moves the mouse to a pixel.");
  m.def(
      "click_mouse",
      [](int client, int button, bool down, double x, double y) {
        const ClientLock lock(client);
        screen_of(lock).click(button, down, x, y);
      },
      "client"_a, "button"_a, "down"_a, "x"_a, "y"_a, "Presses a button of the mouse at a pixel, or lets it go.");
  m.def(
      "hold",
      [](int client, const std::vector<std::tuple<std::string, Numbers, Numbers>>& grips) {
        const ClientLock lock(client);
        std::vector<bullet::Grip>& all = screen_of(lock).grips;
        all.clear();
        for (const auto& [link, point, target] : grips) {
          if (all_finite(point) && all_finite(target)) all.push_back({link, vector(point), vector(target)});
        }
      },
      "client"_a, "grips"_a,
      "What is dragged until the next call: names of links, points in their frames [m], where these go in the world.");
  m.def(
      "set_camera", set_camera, "client"_a, "eye"_a, "target"_a, "moves"_a,
      "Where people have moved the page's camera (3), and what it looks at (3), after so many `camera_moves`: what the "
      "program has set since then stays.");
  m.def(
      "set_size",
      [](int client, int width, int height) {
        const ClientLock lock(client);
        if (width > 0 && height > 0) screen_of(lock).width = width, screen_of(lock).height = height;
      },
      "client"_a, "width"_a, "height"_a, "Of the page's scene [pixels].");
}

}  // namespace

void bind_pybullet_gui(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("pybullet_gui", "Windows of manyhands.pybullet, for who draws them.");
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const bullet::Error& error) {
      PyErr_SetString(pybullet::error_class, error.what());
    }
  });
  bind_items(m);
  bind_frame(m);
  bind_people(m);
  m.def(
      "frame",
      [](int client, std::int64_t seen_items, std::int64_t seen_looks, bool with_model) {
        return (*ClientLock(client)).frame(seen_items, seen_looks, with_model);
      },
      "client"_a, "seen_items"_a = -1, "seen_looks"_a = -1, "with_model"_a = true,
      "What the client shows now, to who has seen items and colours up to these numbers. May be called by any thread.");
  m.def(
      "listen",
      [](const nb::object& opened, const nb::object& closed) {
        pybullet::listeners() = {opened.inc_ref().ptr(), closed.inc_ref().ptr()};
      },
      "opened"_a, "closed"_a,
      nb::sig("def listen(opened: collections.abc.Callable[[int], object], closed: "
              "collections.abc.Callable[[int], object]) -> None"),
      "Who is told of a client with a window once it is connected, and before it goes. Called once.");
  m.def(
      "end",
      [] {
        for (const auto& connection : pybullet::shared().connections) {
          if (connection) pybullet::stop_clock(*connection);
        }
        pybullet::Listeners& all = pybullet::listeners();
        for (PyObject* const listener : {std::exchange(all.opened, nullptr), std::exchange(all.closed, nullptr)}) {
          Py_XDECREF(listener);
        }
      },
      "Before the interpreter ends: no world steps by itself any more, and nobody is told of clients.");
}

}  // namespace manyhands
