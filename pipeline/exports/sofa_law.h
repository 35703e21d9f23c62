#pragma once

namespace palpate::pipeline {

/// The links' law in numpy, as SOFA's scene has it, after the data. The same as skeleton/links/link_energy.h and
/// skeleton/links/full_link.h, without volumes; SofaExport.ItsForcesAreTheModels holds them together.
inline constexpr const char* sofa_law = R"py(

def matrices(q):
    """Rotations (n x 3 x 3) of unit quaternions x, y, z, w."""
    x, y, z, w = q.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1).reshape(-1, 3, 3)


def dot(a, b):
    return np.sum(a * b, 1, keepdims=True)


def turn_between(q_a, q_b):
    """R_b R_a^T as unit quaternions with w >= 0: vector parts and w."""
    u, v, s, t = q_b[:, :3], q_a[:, :3], q_b[:, 3:], q_a[:, 3:]
    vector, w = t * u - s * v - np.cross(u, v), s * t + dot(u, v)
    sign = np.where(w < 0, -1.0, 1.0)
    return sign * vector, sign * w


def paper_gradient(x, R, q):
    """d energy / d (x_b, w_a, w_b) of links with elongation, flexion and torsion."""
    d = x[B] - x[A]
    l = np.linalg.norm(d, axis=1, keepdims=True)
    n = d / l
    d_a, d_b = np.einsum('lij,lj->li', R[A], D0), np.einsum('lij,lj->li', R[B], D0)
    by_x, by_w = K[:, 0:1] * (l - L) * n, []
    for own in (d_a, d_b):
        turn, c = np.cross(own, n), dot(own, n)
        sine = np.linalg.norm(turn, axis=1, keepdims=True)
        slope = np.where((c > 0) & (sine < 1e-9), -1.0, -np.arctan2(sine, c) / np.maximum(sine, 1e-9))
        by_x = by_x + K[:, 1:2] * slope / l * (own - c * n)
        by_w.append(K[:, 1:2] * slope * turn)
    v, w = turn_between(q[A], q[B])
    s = dot(v, d_a)
    y = w * d_a + np.cross(v, d_a)
    twist = K[:, 2:3] * 2 * np.arctan2(s, w) * (w * y + s * v) / np.maximum(s * s + w * w, 1e-24)
    return by_x, by_w[0] - twist, by_w[1] + twist


def full_gradient(x, R, q):
    """The same of links with two flexions and two shears, whose halves meet in the section's centroid."""
    arm_a, arm_b = np.einsum('lij,lj->li', R[A], AT - X[A]), np.einsum('lij,lj->li', R[B], AT - X[B])
    gap = x[B] - x[A] + arm_b - arm_a
    f_a = [np.einsum('lij,lj->li', R[A], AXES[:, i]) for i in range(3)]
    f_b = [np.einsum('lij,lj->li', R[B], AXES[:, i]) for i in range(3)]
    v, w = turn_between(q[A], q[B])
    rest = L - np.linalg.norm(X[B] - X[A], axis=1, keepdims=True)
    part = [dot(f_a[i] + f_b[i], gap) / 2 for i in range(3)]
    pull = [K[:, 0:1] * (part[0] - rest), K[:, 4:5] * part[1], K[:, 5:6] * part[2]]
    bend = [K[:, 2:3] * 2 * dot(v, f_a[0]), K[:, 3:4] * 2 * dot(v, f_a[1]), K[:, 1:2] * 2 * dot(v, f_a[2])]
    F_a, F_b = sum(p * f for p, f in zip(pull, f_a)), sum(p * f for p, f in zip(pull, f_b))
    mean, axis = (F_a + F_b) / 2, sum(p * f for p, f in zip(bend, f_a))
    couple = w * axis + np.cross(v, axis)
    return (mean, np.cross(F_a, gap) / 2 - np.cross(arm_a, mean) - couple,
            np.cross(F_b, gap) / 2 + np.cross(arm_b, mean) + couple)


def forces(x, q):
    """Forces and torques of the links on the spheres (n x 6), at centres x and rotations q from rest."""
    by_x, by_a, by_b = (full_gradient if K.shape[1] == 6 else paper_gradient)(x, matrices(q), q)
    f = np.zeros((len(x), 6))
    np.add.at(f, A, np.hstack([by_x, -by_a]))
    np.add.at(f, B, np.hstack([-by_x, -by_b]))
    return f


def moved(x, q, step):
    """After a small step: displacements and rotation vectors (n x 6)."""
    u, v, w = step[:, 3:] / 2, q[:, :3], q[:, 3:]
    turned = np.hstack([v + w * u + np.cross(u, v), w - dot(u, v)])
    return x + step[:, :3], turned / np.linalg.norm(turned, axis=1, keepdims=True)


def createScene(root):
    import Sofa.Core

    class Links(Sofa.Core.ForceFieldRigid3d):
        def addForce(self, m, out_force, pos, vel):
            self.at = np.array(pos.array())
            with out_force.writeableArray() as f:
                f += forces(self.at[:, :3], self.at[:, 3:])

        def addDForce(self, df, dx, params):
            step = np.array(dx.value if hasattr(dx, 'value') else dx.array())
            size = np.abs(step).max()
            if size == 0:
                return
            h = 1e-6 / size  # the derivative along the step, by differences
            x, q = self.at[:, :3], self.at[:, 3:]
            change = (forces(*moved(x, q, h * step)) - forces(*moved(x, q, -h * step))) / (2 * h)
            with df.writeableArray() as f:
                f += change * params['kFactor']

        def addKToMatrix(self, mparams, n_nodes, n_dofs):
            return np.zeros((0, 3))

    root.dt = 1e-3
    root.gravity = GRAVITY
    root.addObject('RequiredPlugin', pluginName=[
        'SofaPython3', 'Sofa.Component.StateContainer', 'Sofa.Component.ODESolver.Backward',
        'Sofa.Component.LinearSolver.Iterative', 'Sofa.Component.Mass', 'Sofa.Component.Constraint.Projective',
        'Sofa.Component.Mapping.Linear', 'Sofa.GL.Component.Rendering3D'])
    root.addObject('DefaultAnimationLoop')
    body = root.addChild('body')
    body.addObject('EulerImplicitSolver', rayleighStiffness=0.0, rayleighMass=0.1)
    body.addObject('CGLinearSolver', iterations=500, tolerance=1e-10, threshold=1e-10)
    poses = np.hstack([X, np.tile([0.0, 0.0, 0.0, 1.0], (len(X), 1))])
    body.addObject('MechanicalObject', template='Rigid3d', name='spheres', position=poses.tolist())
    body.addObject('UniformMass', totalMass=float(MASS.sum()))
    body.addObject('FixedProjectiveConstraint', indices=HELD)
    body.addObject(Links(name='links'))
    if len(VERTICES):
        skin = body.addChild('skin')
        skin.addObject('OglModel', name='visual', position=VERTICES.tolist(), triangles=TRIANGLES.tolist(),
                       color=[0.8, 0.42, 0.38, 1])
        skin.addObject('SkinningMapping', template='Rigid3d,Vec3d', nbRef=[4] * len(VERTICES),
                       indices=INFLUENCES.tolist(), weight=WEIGHTS.tolist())
    return root
)py";

}  // namespace palpate::pipeline
