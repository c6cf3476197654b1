import numpy as np

from ._error import Error


def matrix(derivatives, rows, columns):
    """Returns what a function given as `jacobian` returned as a matrix rows x columns: itself, or its blocks side by side,
    one for each variable."""
    if isinstance(derivatives, (list, tuple)) and not all(np.ndim(block) == 0 for block in derivatives):
        derivatives = np.concatenate([_block(block, rows) for block in derivatives], axis=1)
    own = np.asarray(derivatives, float)
    if own.ndim < 2 and own.size == rows * columns and 1 in (rows, columns):
        own = own.reshape(rows, columns)
    if own.shape != (rows, columns):
        raise Error(
            f"[slom.wrong-jacobian] the function `jacobian` returns an array of shape {own.shape} for {rows} residuals and "
            f"{columns} components of the variables; return the shape ({rows}, {columns}), or a list with a block for each "
            "variable",
            "jacobian",
        )
    return own


def _block(block, rows):
    block = np.asarray(block, float)
    if block.ndim == 2:
        return block
    return block.reshape(rows, 1) if block.size == rows and rows > 1 else block.reshape(1, -1)
