"""Which of ManipulaPy 1.4.1's own tests are not run here, which fail, and why."""

from typing import NamedTuple


class Difference(NamedTuple):
    """Tests of a file that fail, for one reason."""

    file: str
    tests: str
    """a pattern of names, as of a shell"""
    failures: int | None
    """how many of them fail; None where that depends on how busy the machine is"""
    reason: str


_PRIVATE = "tests its private functions, classes and the layout of its files by hash or by name"
_BACKENDS = "tests arrays of CuPy, PyTorch or JAX, of which there is none here"
_NO_DATA = "reads data files of its repository that the archive on the package index lacks"
_PAGES = "tests the pages and packaging of its repository"

LEFT_OUT = {
    "test_backend_dispatch.py": _BACKENDS,
    "test_control_backend_boundary.py": _BACKENDS,
    "test_control_backend_laws.py": _BACKENDS,
    "test_gradient_contract.py": _BACKENDS,
    "test_jax_call_sites.py": _BACKENDS,
    "test_torch_call_sites.py": _BACKENDS,
    "test_tpu_contract.py": _BACKENDS,
    "test_cuda_kernels.py": _BACKENDS,
    "test_cuda_kernels_cpu.py": _BACKENDS,
    "test_cuda_kernels_restructure_compat.py": _PRIVATE,
    "test_control_restructure_compat.py": _PRIVATE,
    "test_dynamics_restructure_compat.py": _PRIVATE,
    "test_kinematics_restructure_compat.py": _PRIVATE,
    "test_planning_restructure_compat.py": _PRIVATE,
    "test_potential_field_restructure_compat.py": _PRIVATE,
    "test_sim_restructure_compat.py": _PRIVATE,
    "test_v132_regressions.py": f"{_PRIVATE}; of public functions it freezes angular rows as linear ones in "
    "cartesian_space_control, a finite potential on an obstacle itself, a warning of gravity_forces that the "
    "constructor gives here, and the words of an error",
    "test_urdf_security.py": "tests its resolver of paths and its XML parser as modules; manyhands' reader is C++",
    "test_dynamics_golden.py": f"{_NO_DATA}, frozen results of its wrong mass matrix",
    "test_public_api_freeze.py": _NO_DATA,
    "test_urdf_accuracy.py": _NO_DATA,
    "test_urdf_comparison.py": _NO_DATA,
    "test_urdf_native.py": _NO_DATA,
    "test_docs_design.py": _PAGES,
    "test_docs_motion_studies.py": _PAGES,
    "test_docs_tutorials.py": _PAGES,
    "test_packaging_metadata.py": _PAGES,
    "test_robust_ik_demo.py": "holds no test",
}
"""Files, and why they are not run."""

_HULLS = "builds convex hulls by private functions; shapes are the engine's here"
_SOLVERS = "tests private parts of its solver; one solver of manyhands is behind all"

DIFFERENCES = (
    Difference("test_control.py", "*::test_ziegler_nichols_tuning", 1, "freezes Ki = 1.2 Ku / Tu of PI"),
    Difference(
        "test_kinematics.py", "*::test_inverse_kinematics_convergence_failure", 1,
        "expects one iteration more than were allowed",
    ),
    Difference(
        "test_kinematics.py", "*::test_inverse_kinematics_with_plot", 1,
        "expects that a plot changes the Matplotlib backend of the whole program",
    ),
    Difference("test_singularity.py", "test_near_singularity_detection", 1, "the answer is always True"),
    Difference(
        "test_singularity_extended.py", "*::test_near_singularity_at_regular_configuration", 1,
        "the answer is always True, at a regular configuration too",
    ),
    Difference(
        "test_utils.py", "*::test_extract_r_list_revolute_joints", 1,
        "the point is on the other side of the origin: -omega x r of it is not v",
    ),
    Difference("test_utils_extended.py", "*::test_scaled_axis_uses_actual_norm", 1, "the same"),
    Difference(
        "test_sim.py", "*", 39,
        "puts a stand-in in PyBullet's place that knows no physicsClientId (all calls go to client 0), 12 of the 17 "
        "fields of a joint, and 6 joints for 1 pair of limits",
    ),
    Difference("test_ik_helpers_extended.py", "TestClipToLimits::*", 5, "tests a private function"),
    Difference("test_ik_helpers_extended.py", "*::test_pose_distance", 1, "tests a private function"),
    Difference(
        "test_ik_helpers_extended.py", "TestAdaptiveMultiStartIK::test_*exception*", 2,
        "expects that every error of the program's own solver is swallowed",
    ),
    Difference("test_trac_ik.py", "TestInitialGuesses::*", 3, _SOLVERS),
    Difference("test_trac_ik.py", "TestSVDRobustSolve::*", 4, _SOLVERS),
    Difference("test_trac_ik.py", "TestDetectOscillation::*", 5, _SOLVERS),
    Difference("test_trac_ik.py", "TestDLSSolver::*", 3, _SOLVERS),
    Difference("test_trac_ik.py", "TestDLSPerturbationRecovery::*", 2, _SOLVERS),
    Difference("test_trac_ik.py", "TestSQPSolver::*", 2, _SOLVERS),
    Difference("test_trac_ik.py", "TestDefaultErrorFunc::*", 7, _SOLVERS),
    Difference("test_trac_ik.py", "TestDelegatingHelpers::*", 4, _SOLVERS),
    Difference("test_path_planning_cpu.py", "*", 5, "tests kernels of Numba and CUDA by their private names"),
    Difference("test_path_planning_unit.py", "test_batch_joint_trajectory_cpu", 1, "asks a private kernel of Numba"),
    Difference("test_path_planning_unit.py", "test_collision_avoidance_cpu_hook_runs", 1, "tests a private function"),
    Difference(
        "test_path_planning_unit.py", "test_joint_trajectory_collision_hook_runs", 1,
        "expects that joint_trajectory pulls positions towards the goal where the arm touches itself",
    ),
    Difference(
        "test_trajectory_planning.py", "*::test_performance_scaling", None,
        "compares clock times of single calls of some microseconds",
    ),
    Difference("test_potential_field_coverage.py", "TestCollisionCheckerMocked::*", 12, _HULLS),
    Difference("test_potential_field_extended.py", "TestCollisionChecker::*", 3, _HULLS),
    Difference("test_perception.py", "*::test_destructor_cleanup", 1, "calls __del__; rendered cameras hold nothing"),
    Difference("test_vision.py", "*::test_vision_capture_image", 1, "its stand-in renders no segmentation"),
    Difference("test_vision.py", "*::test_vision_extrinsic_matrix_computation", 1, "tests a private function"),
    Difference("test_vision.py", "*::test_vision_basic_functionality_without_pybullet_debug", 1, "the same"),
    Difference("test_vision.py", "*::test_pybullet_debug_camera", 1, "looks at private sliders"),
    Difference("test_vision.py", "*::test_detect_obstacles_depth_rank_domain", 1, "there is no YOLO here"),
)  # fmt: skip
