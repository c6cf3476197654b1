"""What Python adds to Fit: tables for notebooks, pandas and uncertainties, and plots."""

import html

import numpy as np

from ._error import Error


def params(self):
    """The fitted components as a pandas frame: value and standard deviation, by name."""
    import pandas

    rows = self.parameters
    return pandas.DataFrame(
        {"value": [p.value for p in rows], "std": [p.std for p in rows]}, index=[p.name for p in rows]
    )


def uncertainties(self):
    """The fitted components as correlated values of the package `uncertainties`, by name."""
    from uncertainties import correlated_values

    rows = self.parameters
    names = [p.name for p in rows]
    twice = sorted({name for name in names if names.count(name) > 1}) if len(set(names)) < len(names) else []
    if twice:
        raise Error(
            f"[slom.same-name] several fitted components are called {twice[0]}, but these values are found by name; give "
            "each variable its own name",
            twice[0],
        )
    return dict(zip([p.name for p in rows], correlated_values([p.value for p in rows], self.covariance)))


def html_of_fit(self):
    parts = [f"<p><b>{'Converged' if self.converged else 'Not converged'}</b>: {html.escape(self.message)}</p>"]
    parts += [f"<p>{html.escape(text)}</p>" for text in self.warnings]
    kinds = [(k.name, k.measurements, k.residuals, f"{k.final_rss:.6g}", k.derivatives) for k in self.kinds]
    parts.append(_table(("measurement", "count", "residuals", "RSS", "derivatives"), kinds))
    try:
        rows = self.parameters
    except Exception as error:  # the reason stands in place of the standard deviations
        parts.append(f"<p>{html.escape(getattr(error, 'sentence', str(error)))}</p>")
    else:
        values = [(p.name, p.text or f"{p.value:.8g}", f"{p.std:.3g}") for p in rows[:100]]
        if values:
            parts.append(_table(("parameter", "value", "standard deviation"), values))
        if len(rows) > 100:
            parts.append(f"<p>{len(rows) - 100} parameters not shown</p>")
    return "".join(parts)


def _table(head, rows):
    cells = lambda row, tag: "".join(f"<{tag}>{html.escape(str(x))}</{tag}>" for x in row)
    return (
        f"<table><thead><tr>{cells(head, 'th')}</tr></thead><tbody>"
        + "".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows)
        + "</tbody></table>"
    )


def html_of_text(self):
    return f"<pre>{html.escape(str(self))}</pre>"


def plot(self, figure=None, profiles=False):
    """Plots the residuals of each kind of measurements beside the normal distribution, and the correlations of the
    parameters, if there are at most 200. The outermost bars hold all residuals beyond. With profiles=True, the 95 %
    intervals by profiles beside those by standard deviations. Returns the figure. Needs matplotlib."""
    import matplotlib.pyplot as plt

    names = [p.name for p in self.parameters] if self.unknowns <= 200 else []
    count = 1 + (len(names) > 1) + profiles
    figure = figure or plt.figure(figsize=(5 * count, 4), layout="constrained")
    left, *more = figure.subplots(1, count, squeeze=False)[0]
    right = more[0] if len(names) > 1 else None
    is_estimated = self.estimator.sigma == "estimated" and self.redundancy > 0
    scale = np.sqrt(self.chi2_per_dof) if is_estimated else 1
    edges = np.linspace(-5, 5, 41)
    for kind in self.kinds:
        own = self.estimator.residuals(kind.name) / scale
        left.hist(np.clip(own, -5, 5), edges, density=True, histtype="step", label=f"{kind.name} ({kind.residuals})")
    left.plot(edges, np.exp(-edges * edges / 2) / np.sqrt(2 * np.pi), "k:", label="normal distribution")
    left.set(xlabel="residual [standard deviations]", ylabel="density")
    left.legend(frameon=False)
    if right is not None:
        std = np.sqrt(np.diag(self.covariance))
        std[std == 0] = 1
        image = right.imshow(self.covariance / np.outer(std, std), vmin=-1, vmax=1, cmap="RdBu_r")
        figure.colorbar(image, ax=right, label="correlation")
        if len(names) <= 30:
            right.set_xticks(range(len(names)), names, rotation=90)
            right.set_yticks(range(len(names)), names)
    if profiles:
        _plot_intervals(self, more[-1])
    return figure


def _plot_intervals(self, axes):
    rows = self.estimator.intervals().rows
    for i, row in enumerate(rows):
        scale = row.std if row.std > 0 else 1
        axes.plot([(row.lower - row.value) / scale, (row.upper - row.value) / scale], [i, i], "o-C0" if row.is_profile else "o-C7")
    for end in (-1.96, 1.96):
        axes.axvline(end, color="k", linestyle=":")
    axes.set_yticks(range(len(rows)), [row.name for row in rows])
    axes.invert_yaxis()
    axes.set(xlabel="95 % interval minus value [standard deviations]")
