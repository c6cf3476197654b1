"""Writes containers (docs/convert.md) from arrays, piece by piece."""
import numpy as np

MAGIC = b"\x89SLOM\r\n\x1a"
BYTE_ORDER, VERSION, GRAPH, BUNDLE = 0x0102030405060708, 1, 1, 2
HEAD_WORDS, SECTION_WORDS = 7, 8
FACTOR, START = np.uint64(0x9E3779B97F4A7C15), np.uint64(0x736C6F6D)


def mixed(value, word):
    """slom::io::WordHash::add, for arrays."""
    value = (value ^ word) * FACTOR
    return value ^ (value >> np.uint64(32))


def hash_of(words):
    value = START
    with np.errstate(over="ignore"):
        for word in words:
            value = mixed(value, np.uint64(word))
    return value


class Container:
    """A file whose sections are filled in pieces. `sections`: name, whole numbers and numbers of a record, records."""

    def __init__(self, file, content, sections):
        self.out = open(file, "wb")
        self.content, self.sections = content, sections
        self.written = [0] * len(sections)
        self.checksums = [0] * len(sections)
        self.offsets, offset = [], 8 * (HEAD_WORDS + SECTION_WORDS * len(sections))
        for _, whole, real, count in sections:
            self.offsets.append(offset)
            offset += 8 * (whole + real) * count
        self.size = offset

    def add(self, section, whole, real):
        """Adds records: arrays of whole numbers and of numbers, a row for each record."""
        words = np.hstack([np.asarray(part).astype(kind).view("<u8").reshape(len(part), -1)
                           for part, kind in ((whole, "<u8"), (real, "<f8")) if part is not None])
        at = self.written[section]
        with np.errstate(over="ignore"):
            value = mixed(np.full(len(words), START), np.arange(at, at + len(words), dtype=np.uint64))
            for column in words.T:
                value = mixed(value, column)
            self.checksums[section] = (self.checksums[section] + int(np.sum(value))) % 2 ** 64
        self.out.seek(self.offsets[section] + 8 * words.shape[1] * at)
        self.out.write(np.ascontiguousarray(words).tobytes())
        self.written[section] += len(words)

    def close(self):
        words = [int.from_bytes(MAGIC, "little"), BYTE_ORDER, VERSION, self.content, len(self.sections), self.size]
        table = []
        for (name, whole, real, count), offset, written, checksum in zip(self.sections, self.offsets, self.written, self.checksums):
            assert written == count, f"{name}: {written} records instead of {count}"
            padded = name.encode().ljust(24, b"\0")
            table += [int.from_bytes(padded[i:i + 8], "little") for i in (0, 8, 16)] + [whole, real, count, offset, checksum]
        words += [int(hash_of(words + table))] + table
        self.out.seek(0)
        self.out.write(np.array(words, dtype="<u8").tobytes())
        self.out.close()
