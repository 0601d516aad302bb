// What programs attach to bodies, logs, plugins, and devices that are not there.
#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

constexpr Function kAddData{
    "addUserData", "bodyUniqueId, key, value | linkIndex=-1, visualShapeIndex=-1",
    "Keeps a text with a body and returns its id; that of the same key, if there is one.",
    [](Client& client, const Arguments& a) -> PyObject* {
      const int id = a.integer(0);
      if (!client.has_body(id)) throw Error("Error in addUserData: there is no such body");
      return of(client.user_data().add({id, a.integer(3, -1), a.integer(4, -1), a.text(1)}, a.text(2)));
    }};

constexpr Function kGetData{"getUserData", "userDataId", "The text as bytes; None of an unknown id.",
                            [](Client& client, const Arguments& a) -> PyObject* {
                              const auto* const entry = client.user_data().find(a.integer(0));
                              return entry == nullptr ? none() : bytes(entry->value);
                            }};

constexpr Function kDataId{
    "getUserDataId", "bodyUniqueId, key | linkIndex=-1, visualShapeIndex=-1",
    "The id of what a body keeps by a key; -1 if there is none.", [](Client& client, const Arguments& a) -> PyObject* {
      return of(client.user_data().find({a.integer(0), a.integer(2, -1), a.integer(3, -1), a.text(1)}));
    }};

constexpr Function kNumData{"getNumUserData", "bodyUniqueId", "How many texts a body keeps.",
                            [](Client& client, const Arguments& a) -> PyObject* {
                              return of(static_cast<int>(client.user_data().of_body(a.integer(0)).size()));
                            }};

constexpr Function kDataInfo{"getUserDataInfo", "bodyUniqueId, userDataIndex",
                             "Id, key (bytes), body, link and visual shape of one of a body's texts.",
                             [](Client& client, const Arguments& a) -> PyObject* {
                               const std::vector<int> ids = client.user_data().of_body(a.integer(0));
                               const int i = a.integer(1);
                               if (i < 0 || i >= static_cast<int>(ids.size()))
                                 throw Error("Could not get user data info");
                               const int id = ids[static_cast<std::size_t>(i)];
                               const bullet::UserDataKey& key = client.user_data().find(id)->key;
                               return tuple(of(id), bytes(key.name), of(key.body), of(key.link), of(key.visual));
                             }};

constexpr Function kRemoveData{"removeUserData", "userDataId", "Forgets a text.",
                               [](Client& client, const Arguments& a) -> PyObject* {
                                 client.user_data().remove(a.integer(0));
                                 return none();
                               }};

constexpr Function kSyncData{"syncUserData", "| bodyUniqueIds=None", "Of networks; without effect here.",
                             [](Client&, const Arguments&) -> PyObject* { return none(); }};

constexpr Function kStartLog{
    "startStateLogging",
    "loggingType, fileName | objectUniqueIds=None, maxLogDof=-1, bodyUniqueIdA=-1, bodyUniqueIdB=-1, linkIndexA=-2, "
    "linkIndexB=-2, deviceTypeFilter=-1, logFlags=-1",
    "Of videos, returns an id and writes nothing: record with manyhands.recording. Other logs are not supported.",
    [](Client& client, const Arguments& a) -> PyObject* {
      constexpr int kVideo = 3, kTimings = 6, kTimer = 9;
      const int type = a.integer(0);
      (void)a.text(1);
      if (type != kVideo && type != kTimings && type != kTimer) {
        PyErr_SetString(PyExc_NotImplementedError,
                        "startStateLogging: only videos and timings pass, and write nothing; record a world with "
                        "manyhands.recording.Recorder");
        throw PythonError{};
      }
      return of(client.next_log());
    }};

constexpr Function kStopLog{"stopStateLogging", "loggingId", "Ends a log.",
                            [](Client&, const Arguments& a) -> PyObject* { return (void)a.integer(0), none(); }};

constexpr Function kLoadPlugin{"loadPlugin", "pluginPath | postFix=''", "-1: there are no plugins here.",
                               [](Client&, const Arguments& a) -> PyObject* { return (void)a.text(0), of(-1); }};
constexpr Function kUnloadPlugin{"unloadPlugin", "pluginUniqueId", "There are no plugins here.",
                                 [](Client&, const Arguments& a) -> PyObject* { return (void)a.integer(0), none(); }};
constexpr Function kPluginCommand{"executePluginCommand",
                                  "pluginUniqueId | textArgument='', intArgs=None, floatArgs=None",
                                  "-1: there are no plugins here.",
                                  [](Client&, const Arguments& a) -> PyObject* { return (void)a.integer(0), of(-1); }};

constexpr Function kVrEvents{"getVREvents", "| deviceTypeFilter=1, allAnalogAxes=0",
                             "Empty: there are no such devices.",
                             [](Client&, const Arguments&) -> PyObject* { return PyTuple_New(0); }};
constexpr Function kVrCamera{
    "setVRCameraState", "| rootPosition=None, rootOrientation=None, trackObject=-1, trackObjectFlag=-1",
    "There are no such devices.", [](Client&, const Arguments&) -> PyObject* { return none(); }};
constexpr Function kTiming{"submitProfileTiming", "| eventName=''", "Without effect here.",
                           [](Client&, const Arguments&) -> PyObject* { return none(); }};

}  // namespace

void add_extras(Methods& methods) {
  add_to<kAddData>(methods);
  add_to<kGetData>(methods);
  add_to<kDataId>(methods);
  add_to<kNumData>(methods);
  add_to<kDataInfo>(methods);
  add_to<kRemoveData>(methods);
  add_to<kSyncData>(methods);
  add_to<kStartLog>(methods);
  add_to<kStopLog>(methods);
  add_to<kLoadPlugin>(methods);
  add_to<kUnloadPlugin>(methods);
  add_to<kPluginCommand>(methods);
  add_to<kVrEvents>(methods);
  add_to<kVrCamera>(methods);
  add_to<kTiming>(methods);
}

}  // namespace manyhands::pybullet
