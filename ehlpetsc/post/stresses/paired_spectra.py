"""Spectra of loads and of the stresses under them, two real functions to one complex transform.

Everything lies in blocks of LANES frequencies, so that the processor computes several at once: tables as
(blocks, 48, LANES), spectra of loads as (frames, blocks, 8, LANES), in the compiled loops with one axis.
"""

import numpy as np

from ehlpetsc.compiled import compiled

LANES = 32
LOADS = 8  # real and imaginary parts of the spectra of p, q and their slopes
ROWS = 48  # of the tables: eight kernels, each with three even and three odd rows


def blocks_of(n):
    """Blocks that hold the frequencies 0 .. n/2 of a transform of length n."""
    return -(-(n // 2 + 1) // LANES)


def in_blocks(rows):
    """Rows (rows, f) as one axis of blocks (blocks, rows, LANES), zeros at the end."""
    count = -(-rows.shape[1] // LANES)
    padded = np.zeros((rows.shape[0], count * LANES))
    padded[:, : rows.shape[1]] = rows
    return np.ascontiguousarray(padded.reshape(-1, count, LANES).swapaxes(0, 1)).ravel()


@compiled(error_model="python", nogil=True)
def _separate(row, start, cos, sin, out):
    """Spectra of x and y from that of x + iy, shifted by half an element, at frequencies from `start` on."""
    ahead, back, last = row[start:], row[row.size - start - cos.size + 1 :], cos.size - 1
    if start == 0:
        out[0], out[LANES], out[2 * LANES], out[3 * LANES] = row[0].real, 0.0, row[0].imag, 0.0
    for k in range(0 if start else 1, cos.size):
        a, b = ahead[k], back[last - k]
        xr, xi = 0.5 * (a.real + b.real), 0.5 * (a.imag - b.imag)
        yr, yi = 0.5 * (a.imag + b.imag), -0.5 * (a.real - b.real)
        c, s = cos[k], sin[k]
        out[k], out[k + LANES] = xr * c - xi * s, xr * s + xi * c
        out[k + 2 * LANES], out[k + 3 * LANES] = yr * c - yi * s, yr * s + yi * c


@compiled(error_model="python", nogil=True)
def separate(values, slopes, cos, sin, out):
    """Spectra of loads: out (frames, ...) from transforms (frames, n) of p + iq and of their slopes."""
    half = cos.size
    for frame in range(values.shape[0]):
        for start in range(0, half, LANES):
            here = out[frame, start * LOADS : (start + LANES) * LOADS]
            if start + LANES > half:
                here[:] = 0.0
            part = slice(start, min(start + LANES, half))
            _separate(values[frame], start, cos[part], sin[part], here)
            _separate(slopes[frame], start, cos[part], sin[part], here[4 * LANES :])


@compiled(error_model="python", nogil=True, inline="always")
def _kernel(t, number, k, w):
    """Real and imaginary part of a kernel at the offset of these weights."""
    place = 6 * LANES * number + k
    return (
        w[0] * t[place] + w[1] * t[place + LANES] + w[2] * t[place + 2 * LANES],
        w[3] * t[place + 3 * LANES] + w[4] * t[place + 4 * LANES] + w[5] * t[place + 5 * LANES],
    )


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _stress_block(t, weights, loads, out):
    """Real and imaginary parts of the stress spectra of one frame in one block: out (6 LANES).

    Under p, q and their slopes, shifted by half an element. Kernels B, E under values, A, C under slopes are
    i times what the tables hold.
    """
    w = (weights[0], weights[1], weights[2], weights[3], weights[4], weights[5])
    for k in range(out.size // 6):
        ar, ai = _kernel(t, 0, k, w)
        bi, br = _kernel(t, 1, k, w)
        cr, ci = _kernel(t, 2, k, w)
        ei, er = _kernel(t, 3, k, w)
        dai, dar = _kernel(t, 4, k, w)
        dbr, dbi = _kernel(t, 5, k, w)
        dci, dcr = _kernel(t, 6, k, w)
        der, dei = _kernel(t, 7, k, w)
        br, er, dar, dcr = -br, -er, -dar, -dcr
        pr, pi = loads[k], loads[k + LANES]
        qr, qi = loads[k + 2 * LANES], loads[k + 3 * LANES]
        xr, xi = loads[k + 4 * LANES], loads[k + 5 * LANES]
        yr, yi = loads[k + 6 * LANES], loads[k + 7 * LANES]
        out[k] = cr * pr - ci * pi + er * qr - ei * qi + dcr * xr - dci * xi + der * yr - dei * yi
        out[k + LANES] = cr * pi + ci * pr + er * qi + ei * qr + dcr * xi + dci * xr + der * yi + dei * yr
        out[k + 2 * LANES] = ar * pr - ai * pi + br * qr - bi * qi + dar * xr - dai * xi + dbr * yr - dbi * yi
        out[k + 3 * LANES] = ar * pi + ai * pr + br * qi + bi * qr + dar * xi + dai * xr + dbr * yi + dbi * yr
        out[k + 4 * LANES] = br * pr - bi * pi + cr * qr - ci * qi + dbr * xr - dbi * xi + dcr * yr - dci * yi
        out[k + 5 * LANES] = br * pi + bi * pr + cr * qi + ci * qr + dbr * xi + dbi * xr + dcr * yi + dci * yr


@compiled(error_model="python", nogil=True)
def _pair_up(one, other, start, count, row):
    """Write one + i other, given as real and imaginary parts, into the spectrum `row` of 2 n real numbers."""
    n = row.size // 2
    head, tail = row[2 * start :], row[2 * (n - start - count + 1) :]
    for k in range(count):
        xr, xi, yr, yi = one[k], one[k + LANES], other[k], other[k + LANES]
        head[2 * k], head[2 * k + 1] = xr - yi, xi + yr
    for k in range(0 if start else 1, count):
        xr, xi, yr, yi = one[k], one[k + LANES], other[k], other[k + LANES]
        m = 2 * (count - 1 - k)
        tail[m], tail[m + 1] = xr + yi, yr - xi
    if start == 0:  # of real functions these two are real
        row[0], row[1] = one[0], other[0]
    if 2 * (start + count - 1) == n:
        row[n], row[n + 1] = one[count - 1], other[count - 1]


@compiled(error_model="python", nogil=True)
def paired_spectra(tables, weights, loads, out):
    """out (pairs, 3, 2 n): spectra of a frame's stresses plus i times those of the next frame.

    Two real inverse transforms then cost one complex one. A block of the tables stays in the first cache;
    frequencies beyond the last one are zero.
    """
    frames, n = weights.shape[0], out.shape[2] // 2
    half = min(n // 2 + 1, tables.size // ROWS)
    out[:, :, 2 * half : 2 * (n - half + 1)] = 0.0
    both = np.zeros(12 * LANES)
    one, other = both[: 6 * LANES], both[6 * LANES :]
    for start in range(0, half, LANES):
        table = tables[start * ROWS : (start + LANES) * ROWS]
        here = slice(start * LOADS, (start + LANES) * LOADS)
        for pair in range(out.shape[0]):
            _stress_block(table, weights[2 * pair], loads[2 * pair, here], one)
            if 2 * pair + 1 < frames:
                _stress_block(table, weights[2 * pair + 1], loads[2 * pair + 1, here], other)
            else:
                other[:] = 0.0
            for part in range(3):
                rows = slice(2 * part * LANES, (2 * part + 2) * LANES)
                _pair_up(one[rows], other[rows], start, min(LANES, half - start), out[pair, part])
