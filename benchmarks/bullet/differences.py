"""Where manyhands.pybullet is not the real module, and why."""

_STRICT = "a vector of a wrong length is an error here; Bullet passes it over"
_NOW = "always of the present state; Bullet's is that before the last step unless forward kinematics are asked for"

DIFFERENCES = {
    "calculateMassMatrix": "a wrong number of positions is an error here; Bullet reads beyond the list",
    "changeConstraint": "erp counts for gears alone; the rest draws near by a fifth a step, and by at most 1 m/s",
    "changeDynamics": "nothing sleeps, and contacts need no anchors: activationState, sleepThreshold, frictionAnchor, "
    "ccdSweptSphereRadius and contactProcessingThreshold have no effect; joint damping is implicit, where Bullet's "
    "explicit one blows up on light links; Bullet's cap of 100 rad/s holds only where a program sets one",
    "createConstraint": f"frames that are apart meet at 1 m/s at most; {_STRICT}",
    "createMultiBody": _STRICT,
    "getAABB": "shapes have no margin, and the box of a turned cylinder is its own: Bullet's reach farther",
    "getBasePositionAndOrientation": "free motion is exact to second order: with steps of h, Bullet falls g h t / 2 "
    "farther in t; things rest on the ground, not 1 mm above it",
    "getCameraImage": "depth and segmentation agree in more than 95 % of pixels, whose rays go through other corners; "
    "colours have this renderer's light; lightColor, lightDistance, lightSpecularCoeff and renderer have no effect",
    "getClosestPoints": "no margins; where surfaces are parallel any nearest point is right",
    "getCollisionShapeData": "cylinders stay cylinders: Bullet's are hulls of 32 sides",
    "getContactPoints": "contacts are solved to the end; which points of a face carry it, and which body is A where "
    "none is named, is each engine's own; bodies that do not touch have none",
    "getDynamicsInfo": "links merged by URDF_MERGE_FIXED_LINKS have their true centre of mass; so have those of MJCF "
    "files, where Bullet takes the middle of the last geom",
    "getJointInfo": "axes have length 1",
    "getJointState": "limits hold before they are violated; motors reach their forces without Bullet's sweeps",
    "getJointStates": "as getJointState",
    "getLinkState": _NOW,
    "getLinkStates": _NOW,
    "getVisualShapeData": "textures have their ids; without a window, Bullet tells -1",
    "loadSDF": "another globalScaling is an error here",
    "loadURDF": "with useMaximalCoordinates=1 the body is articulated all the same",
    "rayTest": f"reportHitNumber counts from the nearest link; Bullet's order is that of its tree; {_STRICT}",
    "rayTestBatch": "as rayTest",
    "resetBaseVelocity": "a base that stands keeps none; Bullet's drifts",
    "resetSimulation": "deformable worlds are an error here",
    "setJointMotorControl2": "the motor's equation is solved exactly; Bullet's sweeps are run to the end for it",
    "setPhysicsEngineParameter": "what tunes Bullet's solver has no effect: iterations are kept to be read back",
    "setJointMotorControlMultiDof": "a wrong number of targets is an error here",
    "setTimeStep": "0 and less are an error here",
    "startStateLogging": "videos and timings return an id and write nothing; other logs are NotImplementedError",
    "stepSimulation": "always (): there are no solver analytics",
}
"""Of functions that are compared."""

_REFUSED = "NotImplementedError, which says what to use in its place"
_SOFT = "bodies are rigid here: NotImplementedError"
_EMPTY = "no plugins and no such devices here; the real module's answer needs one"

NOT_COMPARED = {
    "calculateInverseKinematics2": _REFUSED,
    "createSoftBodyAnchor": _SOFT,
    "error": "the exception, which wrong input raises",
    "executePluginCommand": _EMPTY,
    "getConstraintState": _REFUSED,
    "getMeshData": _REFUSED,
    "getTetraMeshData": _SOFT,
    "loadBullet": _REFUSED,
    "loadSoftBody": _SOFT,
    "renderImage": _REFUSED,
    "resetMeshData": _SOFT,
    "saveBullet": _REFUSED,
    "saveWorld": _REFUSED,
    "setVRCameraState": _EMPTY,
    "unloadPlugin": _EMPTY,
    "unsupportedChangeScaling": _REFUSED,
    "vhacd": "its parts are CoACD's, not V-HACD's",
}
"""Of functions that are not."""
