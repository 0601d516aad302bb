// Connections, stepping and the world's parameters.
#include <filesystem>

#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"
#include "bindings/pybullet/convex.h"

namespace manyhands::pybullet {

Shared& shared() {
  static Shared all;
  return all;
}

Listeners& listeners() {
  static Listeners all;
  return all;
}

std::shared_ptr<Connection> connection_of(int id) {
  return id >= 0 && id < static_cast<int>(kMostClients) ? shared().connections[static_cast<std::size_t>(id)] : nullptr;
}

ClientLock::ClientLock(int id) : connection_(connection_of(id)) {
  if (!connection_) throw bullet::Error("Not connected to physics server.");
  lock_ = std::unique_lock(connection_->mutex, std::try_to_lock);
  if (lock_.owns_lock()) return;
  const WithoutInterpreter release;  // whoever holds it may wait for the interpreter
  lock_.lock();
}

std::string find_file(const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name, ignored)) return name;
  for (const char* prefix : {"./data/", "../data/", "../../data/"}) {
    if (std::filesystem::is_regular_file(prefix + name, ignored)) return prefix + name;
  }
  const std::filesystem::path found = std::filesystem::path(shared().search_path) / name;
  if (!shared().search_path.empty() && std::filesystem::is_regular_file(found, ignored)) return found.string();
  return {};
}

namespace {

/// Tells a listener of a client; raises what it raises.
void tell(PyObject* listener, int client) {
  if (listener == nullptr) return;
  PyObject* const answer = PyObject_CallFunction(listener, "i", client);
  if (answer == nullptr) throw PythonError{};
  Py_DecRef(answer);
}

void disconnect(int id) {
  const std::shared_ptr<Connection> connection = connection_of(id);
  if (!connection) throw Error("Not connected to physics server.");
  stop_clock(*connection);
  if (connection->method == kGui) tell(listeners().closed, id);
  shared().connections[static_cast<std::size_t>(id)].reset();
}

int connect_free_slot(int method) {
  auto& slots = shared().connections;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (slots[i]) continue;
    slots[i] = std::make_shared<Connection>();
    slots[i]->method = method;
    slots[i]->client.set_decomposer(&convex_parts);
    const int id = static_cast<int>(i);
    if (method != kGui) return id;
    slots[i]->client.open_screen();
    try {
      tell(listeners().opened, id);
    } catch (const PythonError&) {
      slots[i].reset();
      throw;
    }
    return id;
  }
  throw Error("connect: there are " + std::to_string(kMostClients) + " clients already; disconnect some.");
}

constexpr FreeFunction kConnect{
    "connect", "method | key=0, options=''",
    "Makes a client, a world of its own, and returns its id. DIRECT: without a window. GUI: shown in the browser. "
    "SHARED_MEMORY, UDP and TCP: this engine runs inside the program; returns -1.",
    [](const Arguments& a) -> PyObject* {
      const int method = a.integer(0);
      constexpr int kLast = 17;
      if (method < 1 || method > kLast) throw Error("connectPhysicsServer unexpected argument");
      const bool local = method == kDirect || method == kGui || method == 7 || method == 8;
      if (!local) return of(-1);
      return of(connect_free_slot(method == kDirect ? kDirect : kGui));
    }};

constexpr FreeFunction kDisconnect{"disconnect", "", "Ends a client and all that is in its world.",
                                   [](const Arguments& a) -> PyObject* {
                                     disconnect(a.integer(0, 0));
                                     return none();
                                   }};

constexpr FreeFunction kIsConnected{
    "isConnected", "", "1 or 0: whether there is a client of that id.",
    [](const Arguments& a) -> PyObject* { return of(connection_of(a.integer(0, 0)) ? 1 : 0); }};

constexpr FreeFunction kConnectionInfo{
    "getConnectionInfo", "", "A dict: isConnected, connectionMethod.", [](const Arguments& a) -> PyObject* {
      const std::shared_ptr<Connection> found = connection_of(a.integer(0, 0));
      return Py_BuildValue("{s:i,s:i}", "isConnected", found ? 1 : 0, "connectionMethod", found ? found->method : 0);
    }};

constexpr FreeFunction kApiVersion{"getAPIVersion", "", "The version of PyBullet's interface.",
                                   [](const Arguments&) -> PyObject* { return of(202010061); }};
constexpr FreeFunction kNumpy{"isNumpyEnabled", "", "1: pictures are arrays.",
                              [](const Arguments&) -> PyObject* { return of(1); }};

constexpr Function kTimeOut{"setTimeOut", "timeOutInSeconds", "Of networks; without effect here.",
                            [](Client&, const Arguments& a) -> PyObject* { return (void)a.number(0), none(); }};

constexpr Function kReset{"resetSimulation", "| flags=0",
                          "Takes away all bodies, constraints and shapes; gravity is 0. The time step stays.",
                          [](Client& client, const Arguments& a) -> PyObject* {
                            constexpr int kDeformable = 1, kReducedDeformable = 8;
                            if ((a.integer(0, 0) & (kDeformable | kReducedDeformable)) != 0) {
                              throw Error("resetSimulation: deformable bodies are not supported.");
                            }
                            client.reset();
                            return none();
                          }};

constexpr Function kStep{"stepSimulation", "", "Advances the world by one time step.",
                         [](Client& client, const Arguments&) -> PyObject* {
                           {
                             const WithoutInterpreter release;
                             client.step();
                           }
                           return PyTuple_New(0);
                         }};

constexpr Function kTimeStep{"setTimeStep", "timeStep", "The length of a step [s]; 1/240 unless set.",
                             [](Client& client, const Arguments& a) -> PyObject* {
                               client.set_time_step(a.number(0));
                               return none();
                             }};

constexpr Function kGravity{"setGravity", "gravX, gravY, gravZ", "Gravity [m/s^2]; 0 unless set.",
                            [](Client& client, const Arguments& a) -> PyObject* {
                              client.set_gravity({a.number(0), a.number(1), a.number(2)});
                              return none();
                            }};

constexpr FreeFunction kRealTime{"setRealTimeSimulation", "enableRealTimeSimulation",
                                 "1: with a GUI, the world steps by itself in real time, until 0; without, no effect.",
                                 [](const Arguments& a) -> PyObject* {
                                   const bool runs = a.integer(0) != 0;
                                   const int id = a.integer(1, 0);
                                   (*ClientLock(id)).settings().real_time = runs;
                                   Connection& connection = *connection_of(id);
                                   if (connection.method == kGui)
                                     runs ? start_clock(connection) : stop_clock(connection);
                                   return none();
                                 }};

constexpr Function kSetParameters{
    "setPhysicsEngineParameter",
    "| fixedTimeStep=-1, numSolverIterations=-1, useSplitImpulse=-1, splitImpulsePenetrationThreshold=-1, "
    "numSubSteps=-1, collisionFilterMode=-1, contactBreakingThreshold=-1, maxNumCmdPer1ms=-1, enableFileCaching=-1, "
    "restitutionVelocityThreshold=-1, erp=-1, contactERP=-1, frictionERP=-1, enableConeFriction=-1, "
    "deterministicOverlappingPairs=-1, allowedCcdPenetration=-1, jointFeedbackMode=-1, solverResidualThreshold=-1, "
    "contactSlop=-1, enableSAT=-1, constraintSolverType=-1, globalCFM=-1, minimumSolverIslandSize=-1, "
    "reportSolverAnalytics=-1, warmStartingFactor=-1, sparseSdfVoxelSize=-1, numNonContactInnerIterations=-1",
    "Sets the time step, its parts (numSubSteps), how filters combine (collisionFilterMode) and the frame of joint "
    "forces (jointFeedbackMode). Iterations are kept to be read back. The rest tunes Bullet's solver and has no effect "
    "on this one, which solves contacts to the end.",
    [](Client& client, const Arguments& a) -> PyObject* {
      bullet::Settings& settings = client.settings();
      for (const std::size_t i : {0, 3, 6, 9, 10, 11, 12, 15, 17, 18, 21, 24, 25}) {
        if (a.has(i)) (void)a.number(i);
      }
      if (a.integer(1, -1) >= 0) settings.iterations = a.integer(1);
      if (a.integer(26, -1) >= 0) settings.inner_iterations = a.integer(26);
      if (a.integer(5, -1) >= 0) settings.filter_mode = a.integer(5);
      if (a.integer(16, -1) >= 0) settings.joint_feedback_mode = a.integer(16);
      const bool other_parts = a.integer(4, -1) >= 0, other_step = a.number(0, -1) >= 0;
      if (other_parts) settings.substeps = a.integer(4);
      if (other_parts || other_step) client.set_time_step(other_step ? a.number(0) : settings.time_step);
      return none();
    }};

constexpr Function kGetParameters{
    "getPhysicsEngineParameters", "", "A dict of what setPhysicsEngineParameter and setGravity have set.",
    [](Client& client, const Arguments&) -> PyObject* {
      const bullet::Settings& s = client.settings();
      const Vec3<double> g = client.world().gravity();
      return Py_BuildValue("{s:d,s:i,s:i,s:i,s:d,s:d,s:d,s:i}", "fixedTimeStep", s.time_step, "numSubSteps", s.substeps,
                           "numSolverIterations", s.iterations, "useRealTimeSimulation", s.real_time ? 1 : 0,
                           "gravityAccelerationX", g.x, "gravityAccelerationY", g.y, "gravityAccelerationZ", g.z,
                           "numNonContactInnerIterations", s.inner_iterations);
    }};

constexpr Function kContactErp{"setDefaultContactERP", "defaultContactERP",
                               "Tunes Bullet's solver; without effect here.",
                               [](Client&, const Arguments& a) -> PyObject* { return (void)a.number(0), none(); }};
constexpr Function kSimFlags{"setInternalSimFlags", "flags", "Without effect here.",
                             [](Client&, const Arguments& a) -> PyObject* { return (void)a.integer(0), none(); }};

constexpr Function kDetect{"performCollisionDetection", "",
                           "Finds contacts where bodies are now, without a step; their forces are 0.",
                           [](Client& client, const Arguments&) -> PyObject* {
                             client.detect_collisions();
                             return none();
                           }};

constexpr FreeFunction kSearchPath{"setAdditionalSearchPath", "path",
                                   "Where model files are looked for besides; the last call counts, for all clients.",
                                   [](const Arguments& a) -> PyObject* {
                                     shared().search_path = a.text(0);
                                     return none();
                                   }};

constexpr Function kSave{"saveState", "", "Keeps the state of all bodies in memory and returns its id.",
                         [](Client& client, const Arguments&) -> PyObject* { return of(client.save_state()); }};

constexpr Function kRestore{"restoreState", "| stateId=-1, fileName=''",
                            "Goes back to a state, bit for bit, of the same bodies.",
                            [](Client& client, const Arguments& a) -> PyObject* {
                              if (a.has(1) && !a.text(1).empty()) {
                                throw Error("restoreState: files of saveBullet are not supported; use saveState.");
                              }
                              client.restore_state(a.integer(0, -1));
                              return none();
                            }};

constexpr Function kRemoveState{"removeState", "stateUniqueId", "Forgets a state.",
                                [](Client& client, const Arguments& a) -> PyObject* {
                                  client.remove_state(a.integer(0));
                                  return none();
                                }};

}  // namespace

void add_connection(Methods& methods) {
  add_to<kConnect>(methods);
  add_to<kDisconnect>(methods);
  add_to<kIsConnected>(methods);
  add_to<kConnectionInfo>(methods);
  add_to<kApiVersion>(methods);
  add_to<kNumpy>(methods);
  add_to<kTimeOut>(methods);
  add_to<kReset>(methods);
  add_to<kStep>(methods);
  add_to<kTimeStep>(methods);
  add_to<kGravity>(methods);
  add_to<kRealTime>(methods);
  add_to<kSetParameters>(methods);
  add_to<kGetParameters>(methods);
  add_to<kContactErp>(methods);
  add_to<kSimFlags>(methods);
  add_to<kDetect>(methods);
  add_to<kSearchPath>(methods);
  add_to<kSave>(methods);
  add_to<kRestore>(methods);
  add_to<kRemoveState>(methods);
}

}  // namespace manyhands::pybullet
