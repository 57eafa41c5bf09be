# SPDX-License-Identifier: BSD-3-Clause
# YADE: Hertz-Mindlin, no rolling resistance.
#   yade -n -x -jTHREADS yade.py DIR WARM_UP STEPS STATE
import math
import os
import sys
import time

from yade import utils

directory, warm_up, steps, state = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
p = {}
for line in open(directory + '/parameters.in'):
    _, name, _, value = line.split()
    p[name] = float(value)

solid = O.materials.append(FrictMat(young=p['young'], poisson=p['poisson'], density=p['density'],
                                    frictionAngle=math.atan(p['friction'])))
# On a wall YADE takes half the grain's radius as the effective one where the others take all of it;
# E of the pair times sqrt(2) makes up for that.
wall = O.materials.append(FrictMat(young=p['young'] / (math.sqrt(2) - 1), poisson=p['poisson'],
                                   density=p['density'], frictionAngle=math.atan(p['friction'])))
grains = []
for line in open(directory + '/bed.txt'):
    row = [float(word) for word in line.split()]
    grains.append(O.bodies.append(utils.sphere(row[1:4], row[10], material=solid)))
for axis, place, side in ((0, 0.0, 1), (0, p['length'], -1), (1, 0.0, 1), (1, p['width'], -1),
                          (2, 0.0, 1)):
    O.bodies.append(utils.wall(place, axis, sense=side, material=wall))

O.engines = [
    ForceResetter(),
    # Each bound grows by half of what the others call the skin.
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=0.5 * p['skin']),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys(en=p['restitution'], es=p['restitution'])],
        [Law2_ScGeom_MindlinPhys_Mindlin()]),
    NewtonIntegrator(gravity=(0, 0, -p['gravity']), damping=0),
]
O.dt = p['dt']
O.run(warm_up, wait=True)
start = time.perf_counter()
O.run(steps, wait=True)
print('yade seconds', time.perf_counter() - start)

with open(state, 'w') as out:
    for number in grains:
        s = O.bodies[number].state
        row = [float(value) for v in (s.pos, s.vel, s.angVel) for value in v]
        out.write(' '.join([str(number)] + [repr(value) for value in row]) + '\n')
sys.stdout.flush()
os._exit(0)  # YADE's own way out may wait for its threads
