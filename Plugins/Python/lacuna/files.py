# SPDX-License-Identifier: BSD-3-Clause
"""Files that are whole, or not there.

    from lacuna.files import save_data, writing
    save_data("volume.vti", volume, DataMode="Binary")  # as SaveData, but never cut off
    with writing("notes.txt") as name, open(name, "w") as file:
        file.write("all or nothing")
"""
import contextlib
import errno
import fcntl
import os
import resource
import shutil
import stat
import tempfile
import time

ROOM = 1 << 16  # bytes that a disk must have left
PREFIX = ".lacuna-"
OLD = 60  # s, after which a folder that no process holds is removed
ENDS = {".png": b"IEND\xaeB`\x82", **{f".{parallel}vt{kind}": b"</VTKFile>" for parallel in ("", "p") for kind in "iprsut"}}


@contextlib.contextmanager
def writing(path):
    """Yields a name with the ending of path in a folder of its own beside it. After the block the file of that name replaces path, whose
    permissions it takes. A symbolic link is followed and stays. When the block fails, or the file may be cut off, path stays as it was.
    A device or a pipe receives the whole file and stays, too.

    Raises OSError when the folder cannot be written to, when the block has written no file, and when the disk has no room left.
    """
    target = os.path.realpath(path)
    if os.path.isdir(target):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    if os.path.islink(target):
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), path)
    if is_stream(path):
        with tempfile.TemporaryDirectory(prefix=PREFIX) as folder:
            name = os.path.join(folder, os.path.basename(path))
            yield name
            check_whole(name)
            with open(name, "rb") as file, open(path, "wb") as stream:
                shutil.copyfileobj(file, stream)
        return
    with folder_beside(target) as folder:
        name = os.path.join(folder, os.path.basename(path))
        yield name
        check_whole(name)
        if os.path.exists(target):
            take_access(name, target)
        os.replace(name, target)


def is_stream(path):
    """Whether path is a device or a pipe, which no file may replace. It may be gone behind links, as that of /dev/stdout."""
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


@contextlib.contextmanager
def folder_beside(target):
    """Yields a new folder beside a file, and removes it. Folders of processes that were killed are removed, too."""
    place = os.path.dirname(target) or "."
    _remove_left(place)
    with tempfile.TemporaryDirectory(prefix=PREFIX, dir=place, ignore_cleanup_errors=True) as folder:
        hold = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            with contextlib.suppress(OSError):  # a disk without locks
                fcntl.flock(hold, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield folder
        finally:
            os.close(hold)


def _remove_left(place):
    """Removes folders that no living process holds; the system ends a lock with its process, however that ends."""
    for name in os.listdir(place):
        folder = os.path.join(place, name)
        with contextlib.suppress(OSError):
            if not name.startswith(PREFIX) or os.path.islink(folder) or time.time() - os.stat(folder).st_mtime < OLD:
                continue
            hold = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                fcntl.flock(hold, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(hold)


def check_whole(name):
    """Raises OSError for a file that is not there or empty, or that its writer may have cut off: few writers look whether the disk took all."""
    size = os.path.getsize(name)
    if size == 0:
        raise OSError(errno.EIO, "nothing was written", name)
    ending = ENDS.get(os.path.splitext(name)[1].lower())
    with open(name, "rb") as file:
        os.fsync(file.fileno())  # some disks refuse only now
        if ending:
            file.seek(max(0, size - 64))
            if not file.read().rstrip().endswith(ending):
                raise OSError(errno.EIO, "the file is cut off", name)
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    if limit != resource.RLIM_INFINITY and size + ROOM > limit:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG) + "; the file may be cut off", name)
    try:
        with tempfile.TemporaryFile(dir=os.path.dirname(name) or ".", buffering=0) as probe:
            left = ROOM
            while left > 0:
                left -= probe.write(bytes(left))
            os.fsync(probe.fileno())
    except OSError as error:
        raise OSError(error.errno, f"{error.strerror}; the file may be cut off", name) from error


def take_access(path, old):
    """Gives a file owner (where the system lets us), group, permissions and access list of an older one, or it is private."""
    os.chmod(path, 0o600)
    status = os.stat(old)
    try:
        try:
            os.chown(path, status.st_uid, status.st_gid)
        except OSError:
            os.chown(path, -1, status.st_gid)
        for name in (each for each in os.listxattr(old) if each == "system.posix_acl_access"):
            os.setxattr(path, name, os.getxattr(old, name))
        os.chmod(path, stat.S_IMODE(status.st_mode))
    except OSError:
        pass


def save_data(path, proxy, **options):
    """ParaView's SaveData, for formats of one file, by `writing`; without that on a remote server, whose files are not here. Raises
    PipelineError."""
    from lacuna.errors import PipelineError, raising
    from paraview import servermanager
    from paraview.simple import SaveData
    if servermanager.ActiveConnection.IsRemote():
        with raising():
            SaveData(path, proxy, **options)
        return
    try:
        with writing(path) as name:
            with raising():
                SaveData(name, proxy, **options)
            only_file(name, path)
    except OSError as error:
        raise PipelineError(f"{path} cannot be written: {error.strerror}") from error


def only_file(name, path):
    """Raises PipelineError unless its writer has made the file name, alone in its folder; path is what the user calls it."""
    from lacuna.errors import PipelineError
    made = os.listdir(os.path.dirname(name))
    if made != [os.path.basename(name)]:
        raise PipelineError(f"{path} was not written" if not made else
                            f"{path}: ParaView writes several files for this ({', '.join(sorted(made))}); save it in a "
                            "format of one, such as STL, PLY, OBJ or VTP")
