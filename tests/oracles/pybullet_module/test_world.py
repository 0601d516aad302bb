"""Clients, parameters of the world, user data, debug items and logs, without a window."""

import numpy as np
import pytest
from bodies import ARM, add_box

from benchmarks.bullet.beside import Beside, ours, real

SOLVER = {
    "useSplitImpulse": 1,
    "splitImpulsePenetrationThreshold": -0.02,
    "contactBreakingThreshold": 0.02,
    "maxNumCmdPer1ms": 10,
    "enableFileCaching": 0,
    "restitutionVelocityThreshold": 0.1,
    "erp": 0.3,
    "contactERP": 0.1,
    "frictionERP": 0.1,
    "enableConeFriction": 1,
    "deterministicOverlappingPairs": 1,
    "allowedCcdPenetration": 0.01,
    "solverResidualThreshold": 1e-6,
    "contactSlop": 1e-5,
    "enableSAT": 0,
    "constraintSolverType": 1,
    "globalCFM": 0.0,
    "minimumSolverIslandSize": 1,
    "warmStartingFactor": 0.1,
    "numNonContactInnerIterations": 2,
    "numSolverIterations": 80,
    "fixedTimeStep": 0.005,
    "numSubSteps": 2,
    "sparseSdfVoxelSize": 0.1,
    "reportSolverAnalytics": 0,
}


@pytest.mark.parametrize("option", SOLVER)
def test_a_parameter_is_taken(both: Beside, option: str) -> None:
    both.setPhysicsEngineParameter(**{option: SOLVER[option]})
    both.stepSimulation()
    both.getPhysicsEngineParameters()


@pytest.mark.parametrize("seed", range(3))
def test_the_world(both: Beside, rng: np.random.Generator) -> None:
    gravity = rng.normal(size=3).tolist()
    both.setGravity(gravX=gravity[0], gravY=gravity[1], gravZ=gravity[2])
    both.setTimeStep(timeStep=rng.uniform(0.001, 0.01))
    both.setRealTimeSimulation(enableRealTimeSimulation=0)
    both.setDefaultContactERP(defaultContactERP=0.1)
    both.setInternalSimFlags(flags=0)
    both.setTimeOut(timeOutInSeconds=10)
    both.getPhysicsEngineParameters()
    box = add_box(both, [0, 0, 1])
    both.step(5)
    both.getBaseVelocity(box, within=1e-5)
    both.resetSimulation(flags=0)
    both.getPhysicsEngineParameters()


def test_connections(both: Beside) -> None:
    both.isConnected(physicsClientId=0)
    both.isConnected(7)
    both.getConnectionInfo()
    both.getConnectionInfo(physicsClientId=7)
    both.getAPIVersion()
    both.isNumpyEnabled()
    second = both.connect(both.DIRECT)
    third = both.connect(method=both.DIRECT, options="--nothing")
    both.loadURDF("cube_small.urdf", physicsClientId=second)
    both.getNumBodies()
    both.getNumBodies(physicsClientId=second)
    both.setGravity(0, 0, -1, physicsClientId=third)
    both.getPhysicsEngineParameters()
    both.getPhysicsEngineParameters(physicsClientId=third)
    both.disconnect(physicsClientId=second)
    assert both.connect(both.DIRECT) == second
    both.disconnect(second)
    both.disconnect(third)
    both.isConnected(third)
    both.refuses("disconnect", 77)
    both.refuses("connect", 99)
    both.refuses("connect", "DIRECT")


def test_user_data(both: Beside) -> None:
    both.loadURDF(ARM)
    one = both.addUserData(0, "key", "value")
    both.addUserData(bodyUniqueId=0, key="link", value="other", linkIndex=2, visualShapeIndex=0)
    both.addUserData(0, "key", "changed")
    both.getUserData(userDataId=one)
    both.getUserDataId(bodyUniqueId=0, key="link", linkIndex=2, visualShapeIndex=0)
    both.getUserDataId(0, "none")
    both.getNumUserData(bodyUniqueId=0)
    both.getUserDataInfo(bodyUniqueId=0, userDataIndex=1)
    both.syncUserData()
    both.removeUserData(userDataId=one)
    both.getNumUserData(0)
    both.getUserData(one)
    both.refuses("addUserData", 0, "key")
    both.refuses("addUserData", 0, 1, 2)


def test_debug_items(both: Beside) -> None:
    body = both.loadURDF(ARM)
    here, there, red = [0, 0, 0], [1, 0, 0], [1, 0, 0]
    parent = {"parentObjectUniqueId": body, "parentLinkIndex": 2, "lifeTime": 1}
    both.addUserDebugLine(here, there, lineColorRGB=red, lineWidth=2, **parent)
    both.addUserDebugLine(lineFromXYZ=here, lineToXYZ=there, replaceItemUniqueId=0)
    both.addUserDebugText("a", here, textColorRGB=red, textSize=2, **parent)
    both.addUserDebugText(text="a", textPosition=here, textOrientation=[0, 0, 0, 1], replaceItemUniqueId=0)
    both.addUserDebugPoints([here, there], [red, red], pointSize=2, **parent)
    both.addUserDebugPoints(pointPositions=[here], pointColorsRGB=[red], replaceItemUniqueId=0)
    both.addUserDebugParameter("a", rangeMin=-1, rangeMax=2, startValue=0.5)
    both.setDebugObjectColor(body, 2, objectDebugColorRGB=red)
    both.removeUserDebugItem(itemUniqueId=0)
    both.removeAllUserDebugItems()
    both.removeAllUserParameters()
    both.configureDebugVisualizer(flag=both.COV_ENABLE_GUI, enable=0)
    both.configureDebugVisualizer(
        lightPosition=[1, 1, 1],
        shadowMapResolution=1024,
        shadowMapWorldSize=10,
        remoteSyncTransformInterval=0.1,
        shadowMapIntensity=0.5,
        rgbBackground=[1, 1, 1],
    )
    both.resetDebugVisualizerCamera(cameraDistance=2, cameraYaw=30, cameraPitch=-30, cameraTargetPosition=here)
    both.getDebugVisualizerCamera()
    both.getKeyboardEvents()
    both.getMouseEvents()
    both.getVREvents()
    both.refuses("readUserDebugParameter", 0)
    both.refuses("addUserDebugLine", here)
    both.refuses("addUserDebugText", 3, here)
    both.refuses("addUserDebugParameter", 3)
    both.refuses("addUserDebugLine", [0, 0], there)


def test_logs_and_plugins(both: Beside, tmp_path: object) -> None:
    log = both.startStateLogging(both.STATE_LOGGING_VIDEO_MP4, fileName=f"{tmp_path}/video.mp4")
    both.stopStateLogging(loggingId=log)
    both.loadPlugin(pluginPath="eglRendererPlugin_of_nobody", postFix="_x")
    both.submitProfileTiming("event")
    both.submitProfileTiming()
    both.getNumBodies()
    both.refuses("startStateLogging", "video")


def test_constants_have_the_same_values() -> None:
    for name, value in vars(real).items():
        if isinstance(value, int):
            assert getattr(ours, name) == value, name


def test_every_function_is_there() -> None:
    missing = {n for n, f in vars(real).items() if callable(f) and not n.startswith("_") and not hasattr(ours, n)}
    assert not missing
