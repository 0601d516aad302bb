// What PyBullet has and this module has not: each function says so, and what to do.
#include "bindings/pybullet/arguments.h"

namespace manyhands::pybullet {

namespace {

template <const auto& kRefusal>
PyObject* refuse(PyObject*, PyObject* const*, Py_ssize_t, PyObject*) {
  PyErr_Format(PyExc_NotImplementedError, "%s is not in manyhands.pybullet: %s", kRefusal.name, kRefusal.reason);
  return nullptr;
}

struct Refusal {
  const char* name;
  const char* reason;
};

template <const auto& kRefusal>
void add(Methods& methods) {
  static const std::string doc = std::string("Not supported: ") + kRefusal.reason;
  methods.push_back({kRefusal.name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&refuse<kRefusal>)),
                     METH_FASTCALL | METH_KEYWORDS, doc.c_str()});
}

constexpr const char* kSoft = "bodies are rigid here";
constexpr Refusal kLoadSoft{"loadSoftBody", kSoft}, kAnchor{"createSoftBodyAnchor", kSoft},
    kTetra{"getTetraMeshData", kSoft}, kResetMesh{"resetMeshData", kSoft};
constexpr const char* kSnapshot = "keep states with saveState, and worlds with manyhands.World.snapshot";
constexpr Refusal kLoadBullet{"loadBullet", kSnapshot}, kSaveBullet{"saveBullet", kSnapshot},
    kSaveWorld{"saveWorld", kSnapshot};
constexpr Refusal kScaling{"unsupportedChangeScaling", "load the body again with globalScaling"};
constexpr Refusal kRenderImage{"renderImage", "it is the old form of getCameraImage"};
constexpr Refusal kIk2{"calculateInverseKinematics2", "call calculateInverseKinematics for each link"};
constexpr Refusal kMeshData{"getMeshData", "read the mesh file that getVisualShapeData names"};
constexpr Refusal kConstraintState{"getConstraintState", "read the forces of joints with enableJointForceTorqueSensor"};

}  // namespace

void add_refusals(Methods& methods) {
  add<kLoadSoft>(methods);
  add<kAnchor>(methods);
  add<kTetra>(methods);
  add<kResetMesh>(methods);
  add<kLoadBullet>(methods);
  add<kSaveBullet>(methods);
  add<kSaveWorld>(methods);
  add<kScaling>(methods);
  add<kRenderImage>(methods);
  add<kIk2>(methods);
  add<kMeshData>(methods);
  add<kConstraintState>(methods);
}

}  // namespace manyhands::pybullet
