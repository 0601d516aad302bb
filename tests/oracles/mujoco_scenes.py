"""MJCF files: hand-written ones, each about one part of the format, and those of other packages."""

import importlib.util
from pathlib import Path

INERTIAL = '<inertial pos="0.1 -0.2 0.3" mass="1.5" diaginertia="0.02 0.03 0.04"/>'

SCENES = {
    "arm": """
<mujoco model="arm"><compiler angle="radian"/><option timestep="0.004" gravity="0 1 -9"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" pos="0 0 -0.1"/>
    <body name="base" pos="0 0 0.3" quat="0.9 0.1 0.2 0.3"><geom type="box" size="0.1 0.2 0.3"/>
      <body name="upper" pos="0.1 0 0.2" euler="0.3 0.4 0.5">
        <joint name="shoulder" axis="0 1 0.5" pos="0.02 0.03 0.04" range="-1 2" damping="0.3" armature="0.01"
               frictionloss="0.2"/>
        <geom type="capsule" fromto="0 0 0 0.3 0.1 0.2" size="0.04"/>
        <body name="fore" pos="0.3 0.1 0.2">
          <joint name="elbow" axis="1 0 0" ref="0.4" range="-0.5 0.5" limited="true"/>
          <inertial pos="0.1 -0.2 0.3" quat="0.5 0.1 0.7 0.2" mass="1.5" diaginertia="0.02 0.03 0.04"/>
          <geom type="sphere" size="0.05" pos="0 0.1 0"/>
          <site name="tip" pos="0.1 0.2 0.3" zaxis="1 1 0"/>
          <body name="finger" pos="0 0 0.1">
            <joint name="slide" type="slide" axis="1 1 0" ref="-0.1" range="0 0.08"/>
            <geom type="cylinder" size="0.01 0.04" density="500"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="m" joint="shoulder" gear="3" ctrlrange="-1 1" forcerange="-5 5"/>
    <position name="p" joint="elbow" kp="40" kv="3" gear="2" ctrlrange="-0.5 0.5" forcerange="-10 10"/>
    <velocity name="v" joint="slide" kv="7"/>
    <general name="g1" joint="shoulder" gainprm="50" biastype="affine" biasprm="0 -50 -4"/>
    <general name="g2" joint="elbow" gainprm="2.5" gear="2"/>
    <general name="g3" joint="slide" gainprm="6" biastype="affine" biasprm="0 0 -6"/>
    <position name="damped" joint="shoulder" kp="30" dampratio="0.7"/>
    <position name="damped2" joint="slide" kp="30" dampratio="1" gear="3" inheritrange="0.9"/>
  </actuator>
  <keyframe><key name="home" time="0.5" qpos="0.1 0.2 0.03" qvel="1 2 3" ctrl="1 2 3 4 5 6 7 8"/></keyframe>
</mujoco>""",
    "free": f"""
<mujoco><compiler angle="degree" eulerseq="zyx"/>
  <worldbody>
    <body name="box" pos="1 2 3" euler="10 20 30"><freejoint name="f"/><geom type="box" size="0.1 0.2 0.3" mass="2"/>
      <body name="wheel" pos="0.1 0 0"><joint name="b" type="ball" pos="0.1 0.2 0.3" damping="0.1" armature="0.02"/>
        <geom type="ellipsoid" size="0.1 0.2 0.15"/></body>
    </body>
    <body name="fixed" pos="0 0 1"><geom type="sphere" size="0.1"/>
      <body name="hinged" pos="0 0 1"><joint name="h" range="-90 45"/>{INERTIAL}</body></body>
    <body pos="0 0 4"><joint type="free" armature="0.5"/>{INERTIAL}</body>
  </worldbody>
  <keyframe>
    <key qpos="1 2 3 0.9 0.1 0.2 0.3 0.8 -0.1 0.3 0.2 0.4 1 2 3 1 0 0 1" qvel="1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7"/>
  </keyframe>
</mujoco>""",
    "several joints": f"""
<mujoco><worldbody>
    <body name="cart" pos="0 0 1" axisangle="1 2 3 40">
      <joint name="x" type="slide" axis="1 0 0" ref="0.2"/><joint name="y" type="slide" axis="0 1 0"/>
      <joint name="yaw" axis="0 0 1" pos="0.1 0.2 0" ref="30"/><joint name="tilt" axis="1 1 0" pos="0 0 0.3"/>
      {INERTIAL}<geom type="box" size="0.1 0.1 0.1"/>
      <body name="inner" pos="0.1 0.2 0.3"><joint name="h" axis="0 1 0" pos="0.3 0 0"/>
        <joint name="z" type="slide" axis="0 0 1"/>{INERTIAL}</body>
    </body></worldbody></mujoco>""",
    "defaults": f"""
<mujoco><compiler angle="radian"/>
  <default><geom density="300" friction="0.7 0.01 0.002" rgba="1 0 0 1"/><joint damping="0.5" armature="0.03"/>
    <default class="a"><joint axis="1 0 0" range="-1 1"/><geom type="capsule" size="0.03 0.1"/>
      <default class="b"><geom size="0.05 0.2" contype="0" conaffinity="0"/><joint damping="0.1"/></default></default>
    <default class="c"><position kp="77" ctrlrange="-2 2"/></default>
  </default>
  <worldbody>
    <body name="p" childclass="a"><joint name="j1"/><geom name="g1"/>
      <body name="q" pos="0 0 0.5"><joint name="j2" class="b"/><geom name="g2" class="b"/>
        <geom name="g3" density="900" size="0.07" friction="0.4"/>
        <body name="r" childclass="b" pos="0 0 0.5"><joint name="j3"/><geom name="g4" pos="0 0.1 0"/>{INERTIAL}</body>
      </body></body>
  </worldbody>
  <actuator><position name="p1" joint="j1" class="c"/><position name="p2" joint="j2" kp="3"/></actuator>
</mujoco>""",
    "orientations": """
<mujoco><compiler eulerseq="XYz" autolimits="false"/><worldbody>
    <body name="a" pos="1 0 0" xyaxes="1 1 0 -1 1 0.5"><freejoint/>
      <geom type="box" size="0.1 0.2 0.3" zaxis="1 2 -3"/><geom type="box" size="0.1 0.2 0.3" axisangle="0 1 1 50"/>
      <geom type="cylinder" size="0.1" fromto="0 0 1 0 0 0"/><geom type="box" fromto="0 1 0 1 0 0.5" size="0.1"/>
      <geom type="ellipsoid" size="0.1" fromto="0 0 0 0 0 1"/><geom type="capsule" size="0.1 0.2" euler="10 20 30"/>
      <geom type="box" size="0.1 0.2 0.3" quat="1 2 3 4" pos="1 2 3"/><geom zaxis="0 0 -1" type="box" size="1 2 3"/>
      <frame pos="0.1 0.2 0.3" euler="10 20 30"><geom type="sphere" size="0.1" pos="1 0 0"/><site name="s" pos="0 1 0"/>
        <frame quat="0 1 0 0"><body name="b" pos="0 0 1"><joint axis="0 1 0" pos="0 0.1 0"/>
          <geom type="box" size="0.1 0.2 0.3"/></body></frame></frame>
    </body></worldbody></mujoco>""",
    "inertia": """
<mujoco><compiler inertiagrouprange="0 2" balanceinertia="true" boundmass="0.01" boundinertia="1e-4"/><worldbody>
    <body name="full" pos="0 0 1"><freejoint/>
      <inertial pos="0.1 0.2 0.3" mass="2" fullinertia="0.1 0.12 0.15 0.01 0.02 -0.03"/></body>
    <body name="unbalanced" pos="0 0 2"><freejoint/><inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.5"/></body>
    <body name="mixed" pos="0 0 3"><freejoint/><geom size="0.1" mass="3"/><geom type="box" size="1 2 3" group="3"/>
      <geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/><geom type="box" size="1 1 1" contype="0" conaffinity="0"
      group="4"/></body>
    <body name="light" pos="0 0 4"><freejoint/><geom size="0.001"/></body>
  </worldbody></mujoco>""",
    "total mass": """
<mujoco><compiler settotalmass="12" inertiafromgeom="true"/><worldbody>
    <body name="a"><freejoint/><inertial pos="0 0 0" mass="99" diaginertia="1 1 1"/><geom size="0.1"/></body>
    <body name="b"><geom size="0.2"/><body name="c"><joint/><geom size="0.1" pos="1 0 0"/></body></body>
  </worldbody></mujoco>""",
    "mesh": """
<mujoco><asset>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1  1 1 1" scale="0.1 0.2 0.3"/>
    <mesh name="corner" vertex="0 0 0  1 0 0  0 1 0  0 0 1" face="0 2 1 0 1 3 1 2 3 2 0 3" refpos="0.1 0.2 0.3"
          refquat="0.9 0.1 0.2 0.3" inertia="exact"/>
    <mesh name="shell" vertex="0 0 0  1 0 0  0 1 0  0 0 1" face="0 2 1 0 1 3 1 2 3 2 0 3" inertia="shell"/>
    <mesh name="hull" vertex="0 0 0  1 0 0  0 1 0  0 0 1" face="0 2 1 0 1 3 1 2 3 2 0 3" inertia="convex"
          scale="1 1 -1"/>
    <material name="blue" rgba="0 0 1 1"/>
  </asset><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom type="mesh" mesh="wedge" pos="1 2 3" euler="10 20 30"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom type="mesh" mesh="corner" material="blue"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom type="mesh" mesh="shell" mass="2"/></body>
    <body name="d" pos="0 0 4"><freejoint/><geom type="mesh" mesh="hull"/></body>
  </worldbody></mujoco>""",
    "skins": """
<mujoco><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom size="0.1" shellinertia="true" pos="0.1 0 0"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom type="capsule" size="0.1 0.2" shellinertia="true" density="9"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom type="cylinder" size="0.1 0.2" shellinertia="true" mass="2"/></body>
    <body name="d" pos="0 0 4"><freejoint/><geom type="box" size="0.1 0.2 0.3" shellinertia="true"/></body>
    <body name="e" pos="0 0 5"><freejoint/><geom type="ellipsoid" size="0.1 0.2 0.3" shellinertia="true"/></body>
  </worldbody></mujoco>""",
    "frames around inertials": """
<mujoco><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><frame pos="0.1 0 0" euler="0 0 90"><frame euler="30 0 0">
      <inertial pos="0.1 0.2 0" mass="1" diaginertia="1 1.1 1.2" quat="0.9 0.1 0.2 0.3"/></frame></frame></body>
  </worldbody></mujoco>""",
    "legacy mesh": """
<mujoco><asset>
    <mesh name="step" vertex="0 0 0  2 0 0  2 1 0  1 1 0  1 2 0  0 2 0  0 0 1  2 0 1  2 1 1  1 1 1  1 2 1  0 2 1"
          scale="0.1 0.2 0.3" face="0 2 1 0 3 2 0 4 3 0 5 4 6 7 8 6 8 9 6 9 10 6 10 11
          0 1 7 0 7 6 1 2 8 1 8 7 2 3 9 2 9 8 3 4 10 3 10 9 4 5 11 4 11 10 5 0 6 5 6 11"/>
    <mesh name="open" vertex="0 0 0  1 0 0  0 1 0  0 0 1  3 1 2  1 4 1" face="0 2 1 0 1 3 1 2 3 2 4 5 3 5 4"/>
  </asset><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom type="mesh" mesh="step" pos="1 2 3" euler="10 20 30"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom type="mesh" mesh="open" density="300"/></body>
  </worldbody></mujoco>""",
    "small mesh far from its origin": """
<mujoco><asset>
    <mesh name="wedge" vertex="64 64 64  64.015625 64 64  64 64.015625 64  64 64 64.03125" scale="0.1 -0.1 0.1"
          refpos="0.1 0.2 0.3" face="0 2 1 0 1 3 1 2 3 2 0 3"/>
    <mesh name="hull" vertex="64 64 64  64.015625 64 64  64 64.015625 64  64 64 64.03125" scale="0.1 0.1 0.1"
          inertia="convex"/>
  </asset><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom type="mesh" mesh="wedge" density="1e6"/></body>
    <body name="b" pos="0 0 1"><freejoint/><geom type="mesh" mesh="hull" density="1e6"/></body>
  </worldbody></mujoco>""",
    "repeated pairs": """
<mujoco><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom name="g0" size="0.1" friction="0.4" condim="6"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom name="g1" size="0.1" priority="2"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom name="g2" size="0.1"/></body>
  </worldbody><contact><pair geom1="g0" geom2="g1"/><pair geom1="g1" geom2="g0"/>
    <pair geom1="g0" geom2="g2" condim="1"/><pair geom1="g0" geom2="g2" condim="1"/></contact></mujoco>""",
    "contacts": """
<mujoco><worldbody>
    <geom name="floor" type="plane" size="1 1 1" contype="1" conaffinity="6"/>
    <body name="a" pos="0 0 1"><freejoint/><geom name="g0" size="0.1" contype="2" conaffinity="1"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom name="g1" size="0.1" contype="4" conaffinity="2" condim="4"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom name="g2" size="0.1" contype="0" conaffinity="4"/></body>
    <body name="d" pos="0 0 4"><freejoint/><geom name="g3" size="0.1" contype="8" conaffinity="8" condim="1"/></body>
    <body name="e" pos="0 0 5"><freejoint/><geom name="g4" size="0.1" contype="0" conaffinity="0"/></body>
    <body name="f" pos="0 0 6"><freejoint/><geom name="g5" size="0.1" friction="0.3 0.02 0.003" condim="6"/></body>
    <body name="g" pos="0 0 7"><freejoint/><geom name="g6" size="0.1" friction="0.1 0.2 0.3" priority="1"/></body>
    <body name="h" pos="0 0 8"><geom name="g7" size="0.1"/><body name="i" pos="0 0 9"><joint/><geom name="g8" size="0.1"
      condim="1" friction="5"/></body></body>
  </worldbody><contact><pair geom1="g0" geom2="g3" friction="0.8 0.8 0.01 0.002 0.002" condim="6"/>
    <exclude body1="a" body2="b"/></contact></mujoco>""",
    "equalities": f"""
<mujoco><compiler angle="radian"/><worldbody>
    <body name="a" pos="0 0 1" euler="0.1 0.2 0.3"><freejoint/>{INERTIAL}<site name="s1" pos="0.5 0 0"/></body>
    <body name="b" pos="0 1 1" euler="0.3 0.2 0.1"><joint name="j1" ref="0.3"/>{INERTIAL}</body>
    <body name="c" pos="0 2 1"><joint name="j2" type="slide" ref="0.2"/>{INERTIAL}
      <site name="s2" quat="0 1 0 0"/></body>
  </worldbody><equality>
    <connect name="e1" body1="a" body2="b" anchor="0.1 0.2 0.3"/><connect name="e2" body1="b" anchor="0.1 0.2 0.3"/>
    <weld name="e3" body1="a" body2="c"/><weld name="e4" body1="b" body2="c" anchor="0.2 0.1 0"/>
    <weld name="e5" body1="c"/>
    <joint name="e6" joint1="j1" joint2="j2" polycoef="0.5 2 0 0 0"/><connect name="e7" site1="s1" site2="s2"/>
  </equality></mujoco>""",
    "height field": """
<mujoco><asset><hfield name="h" nrow="3" ncol="2" size="1 2 0.5 0.1" elevation="0 1 2 3 4 8"/></asset>
  <worldbody><geom type="hfield" hfield="h" pos="1 2 3"/><body pos="0 0 3"><freejoint/><geom size="0.1"/></body>
  </worldbody></mujoco>""",
    "replicas": f"""
<mujoco><option><flag gravity="disable"/></option><worldbody>
    <replicate count="12" offset="0.2 0 0.1" euler="0 20 10" sep="-"><body name="a" pos="0 0 1">
      <joint name="j" axis="0 1 0"/><geom name="g" size="0.1"/><geom type="box" size="0.1 0.2 0.3"/></body></replicate>
    <body name="ring"><freejoint/>{INERTIAL}<frame pos="1 0 0"><replicate count="3" euler="0 0 60">
      <replicate count="2" offset="0 0 0.5"><geom name="r" type="capsule" size="0.1 0.2" pos="1 0 0"/>
      <site name="s" pos="1 0 0"/></replicate></replicate></frame></body>
  </worldbody></mujoco>""",
    "bounds": """
<mujoco><compiler boundinertia="0.03"/><worldbody>
    <body name="full" pos="0 0 1"><freejoint/>
      <inertial pos="0.1 0.2 0.3" mass="2" fullinertia="0.02 0.05 0.06 0.01 0.002 -0.003"/></body>
    <body name="forces" pos="0 0 2"><joint actuatorfrcrange="-3 3"/><geom size="0.1"/></body>
  </worldbody></mujoco>""",
    "bounds of nothing": f"""
<mujoco><compiler boundmass="0.2" boundinertia="0.01"/><worldbody><frame pos="0 0 3">
    <body name="empty" pos="1 2 3" euler="30 40 50"><freejoint/></body></frame>
    <body name="ghost" pos="0.1 0 1"><joint axis="0 1 0"/><geom size="0.1" mass="0" pos="1 0 0"/>
      <body name="placed" pos="0 0.2 0"><joint/><inertial pos="0.1 0 0" mass="0" diaginertia="0 0 0"/>
        <body name="fixed" pos="0 0.3 0.1"><body name="last" pos="1 0 0"><joint/>{INERTIAL}</body></body></body></body>
  </worldbody></mujoco>""",
    "aligned": f"""
<mujoco><compiler alignfree="true"/><worldbody>
    <body name="two" pos="1 2 3" euler="-150 140 -30"><freejoint/><site name="s" pos="1 1 1"/>
      <geom type="box" size=".1 .2 .3" pos=".1 .2 .3" quat="1 2 3 4"/><geom size=".1" pos="1 0 0"/></body>
    <body name="one" pos="1 2 4"><joint type="free"/><frame euler="0 0 30">
      <geom type="box" size=".1 .3 .2" pos=".1 .2 .3" quat="1 0.2 0.3 0.4"/></frame><geom size=".1" mass="0"/></body>
    <body name="given" pos="1 2 6"><freejoint/><geom size=".1"/><site name="t" euler="0 0 90"/>
      <inertial pos=".3 .2 .1" quat="1 0.5 0 0" mass="1" diaginertia="1 2 2.5"/></body>
    <body name="full" pos="1 2 7"><freejoint/><geom size=".1"/>
      <inertial pos=".3 .2 .1" mass="1" fullinertia="1 2 2.5 0.1 0.2 0.3"/></body>
    <body name="left" pos="1 2 8"><freejoint align="false"/>{INERTIAL}<geom size=".1"/></body>
    <body name="parent" pos="1 2 9"><freejoint/>{INERTIAL}<body pos="0 0 1"><geom size=".1"/></body></body>
  </worldbody><equality><connect body1="two" body2="one" anchor="0.1 0 0"/></equality></mujoco>""",
    "aligned one by one": """
<mujoco><worldbody>
    <body pos="1 2 3"><freejoint/><geom type="box" size=".1 .2 .3" pos=".1 .2 .3"/></body>
    <body pos="1 2 4"><freejoint align="true"/><geom type="box" size=".1 .2 .3" pos=".1 .2 .3" euler="10 20 30"/></body>
  </worldbody></mujoco>""",
    "names": f"""
<mujoco><worldbody><site/><site name="arm"/>
    <body pos="1 0 0"><joint/><joint axis="1 0 0"/>{INERTIAL}<geom size="0.1"/>
      <body name="arm" pos="1 0 0"><joint name="body_1_fixed" pos="0 0 1"/>{INERTIAL}</body></body>
    <body name="body_1_joint_0" pos="2 0 0"><joint name="joint_1" pos="1 0 0"/>{INERTIAL}
      <geom name="geom_2" size="0.1"/></body></worldbody></mujoco>""",
}

# Poses that follow from meshes, whose vertices are float32.
FROM_MESHES = {
    "fitted": """
<mujoco><asset><mesh name="m" vertex="0 0 0  1 0.1 0  0.2 2 0.3  0.1 0.2 0.7  0.9 1.1 0.4"/>
    <mesh name="shell" inertia="shell" vertex="0 0 0  1 0.1 0  0.2 2 0.3  0.1 0.2 0.7  0.9 1.1 0.4"/>
    <mesh name="small" scale="0.01 0.01 0.01" vertex="0 0 0  1 0.1 0  0.2 2 0.3  0.1 0.2 0.7  0.9 1.1 0.4"/>
    <mesh name="cube" vertex="-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1"/></asset><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom type="sphere" mesh="m"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom type="capsule" mesh="m" fitscale="1.5" pos="1 2 3"
      euler="10 20 30"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom type="cylinder" mesh="m"/><geom type="box" mesh="small"/></body>
    <body name="d" pos="0 0 4"><freejoint/><geom type="ellipsoid" mesh="shell" density="100"/></body>
    <body name="e" pos="0 0 5"><freejoint/><geom type="box" mesh="m" mass="3" shellinertia="true"/></body>
    <body name="f" pos="0 0 6"><freejoint/><geom type="capsule" mesh="cube"/></body>
  </worldbody></mujoco>""",
    "fitted to boxes": """
<mujoco><compiler fitaabb="true"/><asset><mesh name="m" vertex="0 0 0  1 0.1 0  0.2 2 0.3  0.1 0.2 0.7  0.9 1.1 0.4"/>
    </asset><worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom type="sphere" mesh="m"/></body>
    <body name="b" pos="0 0 2"><freejoint/><geom type="capsule" mesh="m" fitscale="1.5" pos="1 2 3"
      euler="10 20 30"/></body>
    <body name="c" pos="0 0 3"><freejoint/><geom type="cylinder" mesh="m"/></body>
    <body name="d" pos="0 0 4"><freejoint/><geom type="ellipsoid" mesh="m" density="100"/></body>
    <body name="e" pos="0 0 5"><freejoint/><geom type="box" mesh="m" mass="3"/></body>
  </worldbody></mujoco>""",
    "aligned mesh": """
<mujoco><compiler alignfree="true"/><asset><mesh name="m" vertex="0 0 0  1 0.1 0  0.2 2 0.3  0.1 0.2 0.7  0.9 1.1 0.4"/>
    </asset><worldbody><body pos="1 2 5" euler="-150 140 -30"><freejoint/><site name="s" pos="0.1 0 0"/>
    <geom type="mesh" mesh="m" pos="1 0 0"/></body></worldbody></mujoco>""",
}


def shipped() -> list[Path]:
    found: list[Path] = []
    for package, folder in (("mujoco", "testdata"), ("pybullet_data", "mjcf"), ("gymnasium", "envs/mujoco/assets")):
        spec = importlib.util.find_spec(package)
        if spec is not None and spec.origin is not None:
            found += sorted((Path(spec.origin).parent / folder).glob("*.xml"))
    return found


OWN = [Path(__file__).parent / "scenes" / "attached.xml"]
ALL = [*SCENES, *OWN, *shipped()]
