"""Models of this project under the names of PyBullet's data folder, one module per family.

What programs see of them is as there: file names, the names, order, types, frames and limits of joints, the names and
masses of links, sizes. Shapes, colours and inertias are our own.
"""
