// Lines, texts and sliders on the screen, and its camera. A client without a screen draws nothing, as PyBullet's do.
#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"

namespace manyhands::pybullet {

namespace {

using bullet::DebugItem;
using bullet::Screen;

/// What is drawn is of the client's screen; -1 without one.
PyObject* drawn(Client& client, DebugItem item, int replaced) {
  Screen* const screen = client.screen();
  return of(screen == nullptr ? -1 : screen->add(std::move(item), replaced));
}

/// Three numbers; programs also give a fourth, for an opacity that lines and texts do not have.
Vec3<double> colour(const Arguments& a, std::size_t i, const char* error) {
  if (!a.has(i)) return {1, 1, 1};
  const std::vector<double> numbers = a.numbers(i);
  if (numbers.size() != 3 && numbers.size() != 4) throw Error(error);
  return {numbers[0], numbers[1], numbers[2]};
}

constexpr Function kLine{
    "addUserDebugLine",
    "lineFromXYZ, lineToXYZ | lineColorRGB=[1, 1, 1], lineWidth=1, lifeTime=0, parentObjectUniqueId=-1, "
    "parentLinkIndex=-1, replaceItemUniqueId=-1",
    "Draws a line and returns its id; -1 without a GUI.", [](Client& client, const Arguments& a) -> PyObject* {
      DebugItem item{.kind = DebugItem::kLine};
      item.points = {a.vec3(0, "lineFromXYZ needs 3 numbers."), a.vec3(1, "lineToXYZ needs 3 numbers.")};
      item.colours = {colour(a, 2, "lineColorRGB needs 3 numbers.")};
      item.size = a.number(3, 1);
      item.life = a.number(4, 0);
      item.parent = {a.integer(5, -1), a.integer(6, -1)};
      return drawn(client, std::move(item), a.integer(7, -1));
    }};

constexpr Function kText{"addUserDebugText",
                         "text, textPosition | textColorRGB=[1, 1, 1], textSize=1, lifeTime=0, textOrientation=None, "
                         "parentObjectUniqueId=-1, parentLinkIndex=-1, replaceItemUniqueId=-1",
                         "Writes a text and returns its id; -1 without a GUI.",
                         [](Client& client, const Arguments& a) -> PyObject* {
                           DebugItem item{.kind = DebugItem::kText, .text = a.text(0)};
                           item.points = {a.vec3(1, "textPosition needs 3 numbers.")};
                           item.colours = {colour(a, 2, "textColorRGB needs 3 numbers.")};
                           item.size = a.number(3, 1);
                           item.life = a.number(4, 0);
                           if (a.has(5)) (void)a.quaternion(5, "textOrientation needs 4 numbers.");
                           item.parent = {a.integer(6, -1), a.integer(7, -1)};
                           return drawn(client, std::move(item), a.integer(8, -1));
                         }};

constexpr Function kPoints{
    "addUserDebugPoints",
    "pointPositions, pointColorsRGB | pointSize=1, lifeTime=0, parentObjectUniqueId=-1, parentLinkIndex=-1, "
    "replaceItemUniqueId=-1",
    "Draws points and returns their id; -1 without a GUI.", [](Client& client, const Arguments& a) -> PyObject* {
      DebugItem item{.kind = DebugItem::kPoints};
      item.points = a.points(0, "pointPositions needs a list of 3 numbers each.");
      item.colours = a.points(1, "pointColorsRGB needs a list of 3 numbers each.");
      if (item.points.size() != item.colours.size()) throw Error("number of point positions and colors don't match.");
      item.size = a.number(2, 1);
      item.life = a.number(3, 0);
      item.parent = {a.integer(4, -1), a.integer(5, -1)};
      return drawn(client, std::move(item), a.integer(6, -1));
    }};

constexpr Function kParameter{
    "addUserDebugParameter", "paramName | rangeMin=0, rangeMax=1, startValue=0",
    "Adds a slider, or a button where rangeMin > rangeMax, and returns its id; -1 without a GUI.",
    [](Client& client, const Arguments& a) -> PyObject* {
      DebugItem item{.kind = DebugItem::kParameter, .text = a.text(0)};
      item.low = a.number(1, 0);
      item.high = a.number(2, 1);
      item.value = a.number(3, 0);
      return drawn(client, std::move(item), -1);
    }};

constexpr Function kRead{"readUserDebugParameter", "itemUniqueId", "Where a slider is; how often a button was pressed.",
                         [](Client& client, const Arguments& a) -> PyObject* {
                           Screen* const screen = client.screen();
                           DebugItem* const item = screen == nullptr ? nullptr : screen->find(a.integer(0));
                           if (item == nullptr || item->kind != DebugItem::kParameter) {
                             throw Error("Failed to read parameter.");
                           }
                           return of(item->value);
                         }};

constexpr Function kRemoveItem{"removeUserDebugItem", "itemUniqueId", "Takes what was drawn away.",
                               [](Client& client, const Arguments& a) -> PyObject* {
                                 if (Screen* const screen = client.screen()) screen->remove(a.integer(0));
                                 return none();
                               }};

template <bool kParameters>
PyObject* remove_all(Client& client, const Arguments&) {
  if (Screen* const screen = client.screen()) screen->remove_all(kParameters);
  return none();
}

constexpr Function kRemoveAll{"removeAllUserDebugItems", "", "Takes all away but the sliders.", remove_all<false>};
constexpr Function kRemoveSliders{"removeAllUserParameters", "", "Takes all sliders and buttons away.",
                                  remove_all<true>};

constexpr Function kObjectColour{"setDebugObjectColor", "objectUniqueId, linkIndex | objectDebugColorRGB=None",
                                 "Of wire frames, which this viewer does not draw; without effect.",
                                 [](Client&, const Arguments& a) -> PyObject* {
                                   (void)a.integer(0);
                                   (void)a.integer(1);
                                   (void)a.optional_vec3(2, "objectDebugColorRGB needs 3 numbers.");
                                   return none();
                                 }};

constexpr Function kConfigure{
    "configureDebugVisualizer",
    "| flag=-1, enable=-1, lightPosition=None, shadowMapResolution=-1, shadowMapWorldSize=-1, "
    "remoteSyncTransformInterval=-1, shadowMapIntensity=-1, rgbBackground=None",
    "Switches parts of the viewer on and off: COV_ENABLE_RENDERING while loading, COV_ENABLE_GUI, COV_ENABLE_SHADOWS, "
    "COV_ENABLE_WIREFRAME, COV_ENABLE_MOUSE_PICKING; others are without effect. Of the rest rgbBackground counts.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const int flag = a.integer(0, -1), enable = a.integer(1, -1);
      (void)a.optional_vec3(2, "lightPosition needs 3 numbers.");
      const auto background = a.optional_vec3(7, "rgbBackground needs 3 numbers.");
      Screen* const screen = client.screen();
      if (screen != nullptr && flag >= 0 && enable >= 0) screen->switches[flag] = enable != 0;
      if (screen != nullptr && background) screen->background = background;
      return none();
    }};

constexpr Function kResetCamera{
    "resetDebugVisualizerCamera", "cameraDistance, cameraYaw, cameraPitch, cameraTargetPosition",
    "Puts the viewer's camera somewhere; angles in degrees.", [](Client& client, const Arguments& a) -> PyObject* {
      const Vec3<double> target = a.vec3(3, "cameraTargetPosition needs 3 numbers.");
      const double distance = a.number(0), yaw = a.number(1), pitch = a.number(2);
      if (Screen* const screen = client.screen()) {
        screen->camera = {.distance = distance, .yaw = yaw, .pitch = pitch, .target = target};
        ++screen->camera_moves;
      }
      return none();
    }};

PyObject* camera(Client& client, const Arguments&) {
  const std::array<double, 16> zeros{};
  const Vec3<double> zero{0, 0, 0};
  const Screen* const screen = client.screen();
  if (screen == nullptr) {
    return tuple(of(0), of(0), of(std::span<const double>(zeros)), of(std::span<const double>(zeros)), of(zero),
                 of(zero), of(zero), of(zero), of(0.0), of(0.0), of(0.0), of(zero));
  }
  constexpr double kExtent = 2e4;  // [m]: what is seen at 10 km, from which programs get the rays of pixels
  const auto& c = screen->camera;
  const ScreenMatrices m = screen_matrices(*screen);
  return tuple(of(screen->width), of(screen->height), of(std::span<const double>(m.view)),
               of(std::span<const double>(m.projection)), of(Vec3<double>{0, 0, 1}), of(m.forward),
               of(kExtent * screen->aspect() * m.right), of(kExtent * m.up), of(c.yaw), of(c.pitch), of(c.distance),
               of(c.target));
}

constexpr Function kCamera{"getDebugVisualizerCamera", "",
                           "Width, height, view and projection matrix, up, forward, what is seen of horizontal and "
                           "vertical directions at 10 km, yaw, pitch, distance and target of the viewer's camera.",
                           camera};

constexpr Function kKeys{"getKeyboardEvents", "", "A dict of the keys' codes and states since the last call.",
                         [](Client& client, const Arguments&) -> PyObject* {
                           PyObject* const events = PyDict_New();
                           Screen* const screen = client.screen();
                           if (screen == nullptr) return events;
                           screen->listens_to_keys = true;
                           for (const auto& [key, state] : screen->take_keys()) {
                             PyObject *const k = of(key), *const s = of(state);
                             PyDict_SetItem(events, k, s);
                             Py_DecRef(k);
                             Py_DecRef(s);
                           }
                           return events;
                         }};

constexpr Function kMouse{"getMouseEvents", "", "A tuple of the mouse's events since the last call.",
                          [](Client& client, const Arguments&) -> PyObject* {
                            Screen* const screen = client.screen();
                            if (screen == nullptr) return PyTuple_New(0);
                            screen->listens_to_mouse = true;
                            return tuple_of(std::exchange(screen->mouse, {}), [](const bullet::MouseEvent& e) {
                              return tuple(of(e.type), of(e.x), of(e.y), of(e.button), of(e.state));
                            });
                          }};

}  // namespace

void add_debug(Methods& methods) {
  add_to<kLine>(methods);
  add_to<kText>(methods);
  add_to<kPoints>(methods);
  add_to<kParameter>(methods);
  add_to<kRead>(methods);
  add_to<kRemoveItem>(methods);
  add_to<kRemoveAll>(methods);
  add_to<kRemoveSliders>(methods);
  add_to<kObjectColour>(methods);
  add_to<kConfigure>(methods);
  add_to<kResetCamera>(methods);
  add_to<kCamera>(methods);
  add_to<kKeys>(methods);
  add_to<kMouse>(methods);
}

}  // namespace manyhands::pybullet
