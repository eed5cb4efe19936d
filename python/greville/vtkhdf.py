"""Reads points.vtkhdf, which has the points of a run at all times; needs Debian's python3-h5py."""
from contextlib import contextmanager
from pathlib import Path

from .results import Fields, ResultsError, Series, how_to_install, names_of_fields, np


class PointSeries(Series):
    """The times of a file; series(k) are the Fields of the kth time, as those of a Series.

    A field that has not been written at a time is NaN there.
    """

    def __init__(self, path):
        self.path = Path(path)
        with self._open() as file, self._damage():
            root = file["VTKHDF"]
            n = int(root["Steps"].attrs["NSteps"])
            if n == 0:
                raise ResultsError(f"{path} has no times.")
            self.times = root["Steps/Values"][:n]
            self._first = root["Steps/PointOffsets"][:n]
            self._n_points = root["NumberOfPoints"][()][root["Steps/PartOffsets"][:n]]
            self._names = list(root["PointData"])

    def _open(self):
        try:
            import h5py
        except ImportError:
            raise ResultsError(f"{self.path} cannot be read: " + how_to_install("h5py")) from None
        try:
            return h5py.File(self.path, "r")
        except OSError as error:
            raise ResultsError(f"{self.path} cannot be read: {error}.") from None

    @contextmanager
    def _damage(self):
        """Report what h5py raises where a part of the file is missing or cannot be read."""
        try:
            yield
        except (AttributeError, IndexError, KeyError, OSError, RuntimeError, TypeError, ValueError) as error:
            raise ResultsError(f"{self.path} is damaged, or no file of Greville: {error}.") from None

    def __len__(self):
        return len(self.times)

    @property
    def names(self):
        return self._names

    def __call__(self, k, names=None):
        k = self.place_of(k)
        names = None if names is None else names_of_fields(names)
        for name in names or ():
            if name not in self._names:
                raise ResultsError(f"{self.path} has no field {name}. There are: {', '.join(self._names)}.")
        rows = slice(self._first[k], self._first[k] + self._n_points[k])
        with self._open() as file, self._damage():
            data = file["VTKHDF/PointData"]
            x = file["VTKHDF/Points"][rows]
            fields = {name: data[name][rows] for name in dict.fromkeys(self._names if names is None else names)}
            if any(len(values) != self._n_points[k] for values in (x, *fields.values())):
                raise ValueError(f"it lacks points of the time {self.times[k]} s")
        return Fields(np.asarray(x, float), fields, self.times[k], self.path, None)
