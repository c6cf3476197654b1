"""docs/benchmarks.md from bench/results.json."""
from . import facts, goals, growth, online, tables
from .tables import digits

HEAD = """# Benchmarks

Written by `bench/run` from `bench/results.json`; every number below was measured in that run. How fast is SLoM, how much
memory does it need, and are its results right? It is compared with [Ceres](http://ceres-solver.org) as Debian packages it,
the best-known library for such problems, and with CHOLMOD, the sparse Cholesky factorisation that Ceres uses.

{machine}

## What is compared, and how

* **Problems.** Pose graphs: the map of a robot, poses and relative poses between them. Bundle adjustment (BAL): cameras, points
  in space, and where the cameras see them. Files of the research community, and generated problems that grow.
* **The same for both.** Residuals, start values, weights, loss, what is held, and the stopping rule: an iteration that lowers
  the cost by less than 1e-12 of it ends the fit, and {max_iterations} iterations at most. The cost is the sum of squared whitened
  residuals, without a factor 1/2.
* **SLoM** does what the commands `slom graph` (Gauss-Newton, Levenberg-Marquardt where that leads uphill) and `slom bundle`
  (Levenberg-Marquardt) do: exact derivatives from plain functions, its own block Cholesky factorisation.
* **Ceres** has the parameter blocks of its own examples, automatic derivatives, Levenberg-Marquardt. Graphs:
  SPARSE_NORMAL_CHOLESKY with SuiteSparse. Bundles: DENSE_SCHUR, SPARSE_SCHUR and ITERATIVE_SCHUR (with the preconditioner
  SCHUR_JACOBI), points eliminated first; the best of the three counts. Debian compiles Ceres for any x86-64, this program is
  compiled for this processor, as are Ceres' derivatives, which are templates.
* **Measured.** The programs take turns, each run in a process of its own; the round with the median time counts. One thread
  unless stated. A run of less than half a second is the second one in its process.

| column | what it is |
|---|---|
| build | inserting variables and measurements, which the other times leave out |
| setup | what is done once: for SLoM the order of elimination and the layout of the factor; for Ceres its preprocessor, the order being part of its first iteration |
| iteration | a whole iteration: residuals, derivatives, factorisation, solution, tests; the median of those whose step was taken |
| to 0.1 %, to 1e-6 | setup and iterations until the cost was that near to the lowest that any program found; a dash where it never was |
| memory | the most that the process had resident beside the problem as it was read; of small ones the program itself, some 4 MB, is most |

`variables, measurements` are poses and edges, or cameras with points and observations. A start `chordal` solves for the
rotations first, as `slom graph --init chordal` does. torus3D starts there, because from the start in its file fits end in a worse
minimum; so do MIT, CSAIL and w20000. For w20000 the standard deviations 0.1 m, 0.1 m, 0.04 rad replace
the information in the file, which is not a covariance's inverse.
"""


def machine_text(results):
    m = results["machine"]
    return (f"Machine: {m['processor']}, {m['cores']} cores, {m['instructions']}; {m['compiler']}, `{m['flags']}`; BLAS of CHOLMOD: "
            f"`{m['blas']}`. Dense matrix products (dgemm) by Eigen run at {digits(m['dgemm_1024'] / 1e9)} GFLOP/s on one core, those "
            f"of 48 x 48 at {digits(m['dgemm_48'] / 1e9)}. {results['rounds']} rounds. Load of the machine when the run began "
            f"{results['load']['before']:.2f}, when it ended {results['load']['after']:.2f} (the benchmark itself is 1). On a machine "
            "that others use ratios hold better than times.")


def write_page(results, picture):
    """The page's text; `picture`: name of the SVG next to it."""
    graphs, bundles = facts.select(results, graphs=True), facts.select(results, graphs=False)
    one = graphs + bundles
    two = facts.select(results, threads=2)
    robust = [c for c in results["comparisons"] if c["huber"] > 0]
    grown = facts.select(results, generated=True)
    all_goals = goals.goals_of(results)
    short = goals.shortfalls(all_goals, results)
    most = max((c["max_iterations"] for c in results["comparisons"]), default=0)
    parts = [
        HEAD.format(machine=machine_text(results), max_iterations=most),
        "## What is reached", goals.goals_table(all_goals),
        "Each line is a ratio, better when larger; the goal holds for every problem unless the line says otherwise.",
        "Where it falls short, and what most of the time of those iterations is:\n\n" + short if short else "",
        "## Are the results right?",
        f"Final costs that differ from the lowest found by more than {facts.EQUAL:g} of it; up to {facts.SAME_MINIMUM:g} is the same "
        "minimum not quite reached, more is another minimum, or a fit that the limit of iterations ended. All other final costs of "
        "all tables on this page agree to that.",
        tables.costs([c for c in results["comparisons"]]),
        "## SLoM against the fastest peer", "How many times as long, and as much memory, the best of the peers needs, on one thread.",
        tables.ratios(one),
        "## Pose graphs", tables.per_program(graphs),
        "## Bundle adjustment" if bundles else "", tables.per_program(bundles) if bundles else "",
        "## Where the time goes",
        "Parts of an average iteration on one thread; `rest` is moving the values and the tests for stopping. Ceres' linear solver "
        "includes its normal equations, and the order of elimination once.",
        tables.phases(one),
        "## The factorisation alone",
        "Symbolic: order of elimination and everything that depends on the structure alone. Numeric: SLoM's within its fit, assembly "
        "of the matrix included; CHOLMOD's is the faster of simplicial and supernodal for the same matrix, the best of several. SLoM "
        "merges small fronts where that is faster, so it does more operations; the last column counts those of CHOLMOD.",
        tables.factorizations(graphs, results["machine"]),
        "## Two threads", "The last column compares the final costs to ten digits: equal, or how far apart, relative.", tables.threads(one, two),
        "## Robust loss", "The same with Huber's loss at one standard deviation (one pixel for bundles).", tables.per_program(robust),
        "## How cost grows",
        "Generated problems ([bench/fit/generate_graph.hpp](../bench/fit/generate_graph.hpp), "
        "[generate_scene.hpp](../bench/fit/generate_scene.hpp)), one round. A lattice in the plane has separators of the square root of its size, so a factorisation grows as size to the power 3/2; "
        f"a cubic one as its square. A run is ended after {digits(results['time_limit'])} s; the largest problems, which SLoM fits alone "
        "unless `bench/run` is given `--large`, have ten times as long.",
        f"![time of an iteration against size]({picture})", growth.growth_table(grown),
    ]
    if results.get("linearize"):
        parts += ["## A residual with its Jacobian", "What [bench_linearize](../bench/README.md) measures, on one thread.",
                  tables.linearization(results["linearize"])]
    if results.get("online"):
        parts += ["## Fits that follow their data", online.section(results["online"])]
    return "\n\n".join(part.strip() for part in parts if part) + "\n"
