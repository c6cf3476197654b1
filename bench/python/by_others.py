"""The jobs of fits.py that other programs do: SciPy, CasADi, JAX, SymForce and GTSAM."""
import os
import time

import numpy as np

from problems import circle, path_of, read_graph, rotations


class PlanarGraph:
    """Residuals of a graph in the plane and their derivatives, whitened, vectorised. Pose 0 is fixed."""

    def __init__(self, problem):
        self.problem, self.n = problem, len(problem.poses)
        self.whiten = np.linalg.cholesky(problem.information).transpose(0, 2, 1)
        rows = np.arange(3 * len(problem.i)).reshape(-1, 3, 1)
        columns = np.concatenate([3 * problem.i[:, None] + np.arange(3), 3 * problem.j[:, None] + np.arange(3)], 1) - 3
        self.rows, self.columns = (np.broadcast_to(x, (len(problem.i), 3, 6)) for x in (rows, columns[:, None, :]))
        self.free = self.columns >= 0

    def poses(self, x):
        return np.vstack([self.problem.poses[:1], x.reshape(-1, 3)])

    def residuals(self, x):
        poses, p = self.poses(x), self.problem
        a, b = poses[p.i], poses[p.j]
        c, s = np.cos(a[:, 2]), np.sin(a[:, 2])
        dx, dy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1]
        r = np.array([c * dx + s * dy, c * dy - s * dx, b[:, 2] - a[:, 2]]).T - p.measured
        r[:, 2] = (r[:, 2] + np.pi) % (2 * np.pi) - np.pi
        return (self.whiten @ r[:, :, None]).ravel()

    def jacobian(self, x):
        poses, p = self.poses(x), self.problem
        a, b = poses[p.i], poses[p.j]
        c, s = np.cos(a[:, 2]), np.sin(a[:, 2])
        dx, dy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1]
        J = np.zeros((len(p.i), 3, 6))
        J[:, 0, 0], J[:, 0, 1], J[:, 0, 2] = -c, -s, c * dy - s * dx
        J[:, 1, 0], J[:, 1, 1], J[:, 1, 2] = s, -c, -c * dx - s * dy
        J[:, 0, 3], J[:, 0, 4], J[:, 1, 3], J[:, 1, 4] = c, s, -s, c
        J[:, 2, 2], J[:, 2, 5] = -1, 1
        return self.matrix(self.whiten @ J)

    def matrix(self, J):
        from scipy.sparse import csr_matrix

        return csr_matrix((J[self.free], (self.rows[self.free], self.columns[self.free])),
                          shape=(3 * len(self.problem.i), 3 * (self.n - 1)))

    def start(self):
        return self.problem.poses[1:].ravel().copy()


def scipy_graph(data, name, derivatives):
    from scipy.optimize import least_squares

    graph = PlanarGraph(read_graph(path_of(data, name)))
    x = graph.start()
    start = time.perf_counter()
    if derivatives == "numeric":
        options = {"jac_sparsity": graph.matrix(np.ones((len(graph.problem.i), 3, 6)))}
    else:
        options = {"jac": graph.jacobian}
    # With lsmr's own tolerances of 1e-6, the fit creeps and ends after 200 evaluations.
    options["tr_options"] = {"atol": 1e-10, "btol": 1e-10, "regularize": False}
    found = least_squares(graph.residuals, x, method="trf", tr_solver="lsmr", x_scale="jac", max_nfev=200, **options)
    return result_of(found, time.perf_counter() - start)


def result_of(found, wall):
    return {"wall": wall, "rss": float(2 * found.cost), "iterations": found.njev, "message": found.message}


def scipy_circle(solver):
    from scipy.optimize import least_squares
    from scipy.sparse import csr_matrix

    points = circle()
    residuals = lambda x: (np.hypot(points[:, 0] - x[0], points[:, 1] - x[1]) - x[2]) / 0.1  # noqa: E731
    options = {"jac_sparsity": csr_matrix(np.ones((len(points), 3)))} if solver == "lsmr" else {}
    start = time.perf_counter()
    found = least_squares(residuals, np.array([0.0, 0.0, 1.0]), tr_solver=solver, x_scale="jac", **options)
    return result_of(found, time.perf_counter() - start)


def casadi_graph(data, name):
    """Gauss-Newton with exact derivatives of an edge from CasADi's virtual machine, mapped over all edges. SuperLU
    solves the system."""
    import casadi
    import scipy.sparse.linalg  # noqa: F401: not part of the insertion

    graph = PlanarGraph(read_graph(path_of(data, name)))
    p = graph.problem
    start = time.perf_counter()
    ab, z = casadi.SX.sym("ab", 6), casadi.SX.sym("z", 3)
    W = casadi.SX.sym("W", 3, 3)
    c, s = casadi.cos(ab[2]), casadi.sin(ab[2])
    dx, dy, turn = ab[3] - ab[0], ab[4] - ab[1], ab[5] - ab[2] - z[2]
    turn = casadi.atan2(casadi.sin(turn), casadi.cos(turn))
    r = W @ casadi.vertcat(c * dx + s * dy - z[0], c * dy - s * dx - z[1], turn)
    edge = casadi.Function("edge", [ab, z, W], [r, casadi.densify(casadi.jacobian(r, ab))]).map(len(p.i))
    z_all = p.measured.T
    W_all = graph.whiten.transpose(1, 0, 2).reshape(3, -1)

    def evaluate(x):
        poses = graph.poses(x)
        r, J = edge(np.hstack([poses[p.i], poses[p.j]]).T, z_all, W_all)
        return np.array(r).T.ravel(), np.array(J).reshape(3, -1, 6).transpose(1, 0, 2)

    return gauss_newton(graph, evaluate, start)


def jax_graph(data, name):
    """Gauss-Newton with exact derivatives of an edge from JAX, compiled for all edges: the compilation is the insertion.
    SuperLU solves the system."""
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    import jax
    import jax.numpy as jnp
    import scipy.sparse.linalg  # noqa: F401: not part of the insertion

    jax.config.update("jax_enable_x64", True)
    graph = PlanarGraph(read_graph(path_of(data, name)))
    p = graph.problem
    start = time.perf_counter()

    def edge(ab, z, W):
        c, s = jnp.cos(ab[2]), jnp.sin(ab[2])
        dx, dy, turn = ab[3] - ab[0], ab[4] - ab[1], ab[5] - ab[2] - z[2]
        turn = jnp.arctan2(jnp.sin(turn), jnp.cos(turn))
        r = W @ jnp.array([c * dx + s * dy - z[0], c * dy - s * dx - z[1], turn])
        return r, r

    edges = jax.jit(jax.vmap(jax.jacfwd(edge, has_aux=True)))

    def evaluate(x):
        poses = graph.poses(x)
        J, r = edges(np.hstack([poses[p.i], poses[p.j]]), p.measured, graph.whiten)
        return np.asarray(r).ravel(), np.asarray(J)

    evaluate(graph.start())  # compiles
    return gauss_newton(graph, evaluate, start)


def gauss_newton(graph, evaluate, start):
    """Fits the graph. `evaluate` returns residuals and derivatives; it was made since `start`."""
    from scipy.sparse.linalg import splu

    ready = time.perf_counter()
    x = graph.start()
    r, J = evaluate(x)
    rss, iterations = r @ r, 0
    while iterations < 100:
        A = graph.matrix(J)
        x = x - splu((A.T @ A).tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(A.T @ r)
        r, J = evaluate(x)
        iterations, before, rss = iterations + 1, rss, r @ r
        if before - rss < 1e-9 * before:
            break
    end = time.perf_counter()
    return {"wall": end - ready, "insert": ready - start, "rss": float(rss), "iterations": iterations}


def symforce_graph(data, name):
    """SymForce's own Levenberg-Marquardt, with a function of an edge that it generates when the fit begins."""
    import symforce

    symforce.set_log_level("ERROR")
    import symforce.symbolic as sf
    from symforce.opt.factor import Factor
    from symforce.opt.optimizer import Optimizer
    from symforce.values import Values

    graph = PlanarGraph(read_graph(path_of(data, name)))
    p = graph.problem

    def edge(a: sf.Pose2, b: sf.Pose2, z: sf.V3, W: sf.M33, epsilon: sf.Scalar) -> sf.V3:
        back = a.R.inverse()
        t = back * (b.t - a.t)
        turn = (sf.Rot2.from_angle(z[2]).inverse() * (back * b.R)).to_tangent(epsilon)[0]
        return W * sf.V3(t[0] - z[0], t[1] - z[1], turn)

    poses, measured, whiten = p.poses.tolist(), p.measured.tolist(), graph.whiten.tolist()
    start = time.perf_counter()
    factors = [Factor(residual=edge, keys=[f"p[{i}]", f"p[{j}]", f"z[{k}]", f"W[{k}]", "epsilon"])
               for k, (i, j) in enumerate(zip(p.i.tolist(), p.j.tolist()))]
    optimizer = Optimizer(factors=factors, optimized_keys=[f"p[{k}]" for k in range(1, len(poses))],
                          params=Optimizer.Params(iterations=50, verbose=False, early_exit_min_reduction=1e-9))
    values = Values(epsilon=1e-12, p=[sf.Pose2(sf.Rot2.from_angle(x[2]), sf.V2(*x[:2])) for x in poses],
                    z=[sf.V3(*z) for z in measured], W=[sf.M33(W) for W in whiten])
    ready = time.perf_counter()
    result = optimizer.optimize(values)
    end = time.perf_counter()
    return {"wall": end - ready, "insert": ready - start, "rss": 2 * result.error(), "iterations": len(result.iterations)}


def gtsam_graph(data, name, factor):
    """Gauss-Newton. `custom` is SLoM's residual in Python, `between` GTSAM's own in C++, which weighs other errors."""
    import gtsam

    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    problem = read_graph(path_of(data, name))
    pose = lambda x, R: gtsam.Pose3(gtsam.Rot3(R), x[:3])  # noqa: E731
    starts = [pose(x, R) for x, R in zip(problem.poses, rotations(problem.poses))]
    measured = [pose(x, R) for x, R in zip(problem.measured, rotations(problem.measured))]
    start = time.perf_counter()

    def error_of(z):
        back, t = z.rotation().inverse(), z.translation()

        def error(factor, values, jacobians):
            keys = factor.keys()
            a, b = values.atPose3(keys[0]), values.atPose3(keys[1])
            if jacobians is None:
                ab = a.between(b)
                return np.concatenate([ab.translation() - t, gtsam.Rot3.Logmap(back * ab.rotation())])
            H1, H2 = np.zeros((6, 6), order="F"), np.zeros((6, 6), order="F")
            ab = a.between(b, H1, H2)
            D = np.zeros((3, 3), order="F")
            e = np.concatenate([ab.translation() - t, gtsam.Rot3.Logmap(back * ab.rotation(), D)])
            R = ab.rotation().matrix()
            for k, H in enumerate((H1, H2)):
                jacobians[k] = np.vstack([R @ H[3:], D @ H[:3]])
            return e

        return error

    factors = gtsam.NonlinearFactorGraph()
    values = gtsam.Values()
    for k, x in enumerate(starts):
        values.insert(k, x)
    swap = np.r_[3:6, 0:3]
    for i, j, z, information in zip(problem.i.tolist(), problem.j.tolist(), measured, problem.information):
        if factor == "custom":
            noise = gtsam.noiseModel.Gaussian.Information(information)
            factors.add(gtsam.CustomFactor(noise, [i, j], error_of(z)))
        else:
            noise = gtsam.noiseModel.Gaussian.Information(information[np.ix_(swap, swap)])
            factors.add(gtsam.BetweenFactorPose3(i, j, z, noise))
    factors.add(gtsam.NonlinearEqualityPose3(0, starts[0]))
    insertion = time.perf_counter() - start
    start = time.perf_counter()
    rss, iterations = 2 * factors.error(values), 0
    while iterations < 100:  # in Python: GTSAM's optimizer copies all values for each call of a custom factor
        values = values.retract(factors.linearize(values).optimize())
        iterations, before, rss = iterations + 1, rss, 2 * factors.error(values)
        if before - rss < 1e-9 * before:
            break
    wall = time.perf_counter() - start
    return {"wall": wall, "insert": insertion, "rss": rss, "iterations": iterations}


def job(name, data):
    program, kind, *rest = name.split(":")
    if program == "casadi":
        return casadi_graph(data, kind)
    if program in ("jax", "symforce"):
        return (jax_graph if program == "jax" else symforce_graph)(data, kind)
    if program == "gtsam":
        return gtsam_graph(data, kind, *rest)
    return scipy_circle(*rest) if kind == "circle" else scipy_graph(data, kind, *rest)
