"""docs/benchmarks.md from bench/results.json."""
from . import facts, goals, growth, online, tables
from .tables import digits

HEAD = """# Benchmarks

How fast is SLoM, how much memory does it need, and are its results right? This page compares it with
[Ceres](http://ceres-solver.org) as Debian packages it, the best-known library for such problems, and with CHOLMOD, the sparse
Cholesky factorisation that Ceres uses. `bench/run` wrote the page from `bench/results.json`; every number was measured in that run.

{machine}

## What is compared, and how

* **Problems.** Pose graphs: the map of a robot, with poses and relative poses between them. Bundle adjustment (BAL): cameras,
  points in space, and where the cameras see the points. There are files of the research community, and generated problems of
  increasing size.
* **The same for both.** Residuals, start values, weights, loss, fixed variables and the stopping rule are the same. A fit ends if
  an iteration lowers the cost by less than 1e-12 of it, or after {max_iterations} iterations. The cost is the sum of squared
  whitened residuals, without a factor 1/2.
* **SLoM** does what the commands do: `slom graph` uses Gauss-Newton, and Levenberg-Marquardt if a step leads uphill; `slom bundle`
  uses Levenberg-Marquardt. Derivatives are exact, from plain functions. The block Cholesky factorisation is SLoM's own.
* **Ceres** has the parameter blocks of its own examples, automatic derivatives and Levenberg-Marquardt. Graphs use
  SPARSE_NORMAL_CHOLESKY with SuiteSparse. Bundles use DENSE_SCHUR, SPARSE_SCHUR and ITERATIVE_SCHUR (with the preconditioner
  SCHUR_JACOBI), with points eliminated first; the best of the three counts. Debian compiles Ceres for any x86-64. The benchmark
  is compiled for this processor, and so are Ceres' derivatives, which are templates.
* **Measured.** The programs take turns, and each run has a process of its own. The round with the median time counts. Runs use one
  thread unless stated otherwise. A run of less than half a second is the second one in its process.

| column | what it is |
|---|---|
| build | time to insert variables and measurements; the other times do not include it |
| setup | work that is done once: for SLoM the order of elimination and the layout of the factor, for Ceres its preprocessor (its order is part of its first iteration) |
| iteration | a whole iteration: residuals, derivatives, factorisation, solution, tests; the median over accepted steps |
| to 0.1 %, to 1e-6 | setup and iterations until the cost was that near to the lowest cost that any program found; a dash if it never was |
| memory | the largest resident memory of the process, without the problem as it was read; for small problems most of it is the program itself, about 4 MB |

`variables, measurements` are poses and edges, or cameras with points and observations. A start `chordal` solves for the
rotations first, as `slom graph --init chordal` does. torus3D starts there, because from the start in its file fits end in a worse
minimum. MIT, CSAIL and w20000 start there too. For w20000, the standard deviations 0.1 m, 0.1 m, 0.04 rad replace the information in
the file, which is not the inverse of a covariance.
"""


def machine_text(results):
    m = results["machine"]
    return (f"Machine: {m['processor']}, {m['cores']} cores, {m['instructions']}; {m['compiler']}, `{m['flags']}`; BLAS of CHOLMOD: "
            f"`{m['blas']}`. Large dense matrix products (dgemm) by Eigen run at {digits(m['dgemm_1024'] / 1e9)} GFLOP/s on one core, "
            f"products of 48 x 48 at {digits(m['dgemm_48'] / 1e9)} GFLOP/s. There were {results['rounds']} rounds. The load of the machine "
            f"was {results['load']['before']:.2f} at the start of the run and {results['load']['after']:.2f} at its end (the benchmark itself "
            "is 1). On a shared machine, ratios are more reliable than times.")


def write_page(results, picture):
    """Returns the page's text. `picture`: name of the SVG next to it."""
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
        "Each line is a ratio; larger is better. The goal holds for every problem unless the line says otherwise.",
        "These goals are missed:\n\n" + short if short else "",
        "## Are the results right?",
        f"The table lists the final costs that differ from the lowest one found by more than {facts.EQUAL:g} of it. Up to "
        f"{facts.SAME_MINIMUM:g}, the fit did not quite reach the same minimum. Beyond that, it ended in another minimum, or at the limit "
        f"of iterations. All other final costs on this page agree with the lowest one to {facts.EQUAL:g}.",
        tables.costs([c for c in results["comparisons"]]),
        "## SLoM against the fastest peer", "The table says how many times as much time and memory the best of the peers needs, on one thread.",
        tables.ratios(one),
        "## Pose graphs", tables.per_program(graphs),
        "## Bundle adjustment" if bundles else "", tables.per_program(bundles) if bundles else "",
        "## Where the time goes",
        "The table has the parts of an average iteration on one thread. `rest` is moving the values and the tests for stopping. Ceres' "
        "linear solver includes its normal equations, and once the order of elimination.",
        tables.phases(one),
        "## The factorisation alone",
        "*Symbolic* is the order of elimination and everything that depends on the structure alone. *Numeric* is, for SLoM, the "
        "factorisation in its fit, with the assembly of the matrix. For CHOLMOD it is the faster of simplicial and supernodal for the same "
        "matrix, the best of several runs. SLoM merges small fronts if that is faster, so it does more operations. The last column counts "
        "the operations of CHOLMOD.",
        tables.factorizations(graphs, results["machine"]),
        "## Two threads", "The last column compares the final costs to ten digits: equal, or their relative difference.", tables.threads(one, two),
        "## Robust loss", "These are the same problems with Huber's loss at one standard deviation (one pixel for bundles).", tables.per_program(robust),
        "## How cost grows",
        "The problems are generated ([bench/fit/generate_graph.hpp](../bench/fit/generate_graph.hpp), "
        "[generate_scene.hpp](../bench/fit/generate_scene.hpp)), and there is one round. A lattice in the plane has separators of the "
        "square root of its size, so the cost of a factorisation grows as size to the power 3/2. For a cubic lattice, it grows as the "
        f"square of the size. A run is ended after {digits(results['time_limit'])} s. The largest problems have ten times as long; only SLoM "
        "fits them, unless `bench/run` is given `--large`.",
        f"![time of an iteration against size]({picture})", growth.growth_table(grown),
    ]
    if results.get("linearize"):
        parts += ["## A residual with its Jacobian", "[bench_linearize](../bench/README.md) measures this, on one thread.",
                  tables.linearization(results["linearize"])]
    if results.get("online"):
        parts += ["## Fits that follow their data", online.section(results["online"])]
    return "\n\n".join(part.strip() for part in parts if part) + "\n"
