/* Preloaded into a program under test: the N-th operation that changes something below a folder fails, or ends the process.
 *
 * FAULT_ROOT  the folder           FAULT_AT   N, from 1; 0: none
 * FAULT_KIND  full: no space from there on; error: an I/O error once; kill: the process is killed; power: killed, and
 *             what was not synced is lost: bytes, and renames and removals in folders; interrupt: SIGINT, nothing fails
 * FAULT_LOG   file for the number of operations
 *
 * A write that fails has written half of its bytes. What a rename or removal replaces is kept beside the folder until then. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define MOST 4096
#define REAL(name, type) ((type)dlsym(RTLD_NEXT, #name))

static long at, seen;
static const char *root = "", *kind = "";
/* Files that were written: their descriptor (-1: closed), path, and the bytes that are safe. */
static struct { int fd; char path[1024]; off_t safe; } files[MOST];
static int count;
/* Renames (from `from`; "" for a removal, "/" for that of a folder) of what is now at `to`, not yet synced, and where the old one is
 * kept ("": none). */
static struct { char from[1024], to[1024], kept[1024]; } changes[MOST];
static int changed;
/* Folders that are open: their descriptors and paths. */
static struct { int fd; char path[1024]; } folders[64];

__attribute__((constructor)) static void begin(void) {
    if (getenv("FAULT_ROOT")) root = getenv("FAULT_ROOT");
    if (getenv("FAULT_KIND")) kind = getenv("FAULT_KIND");
    if (getenv("FAULT_AT")) at = atol(getenv("FAULT_AT"));
}

__attribute__((destructor)) static void end(void) {
    FILE *log = getenv("FAULT_LOG") ? fopen(getenv("FAULT_LOG"), "a") : NULL;
    if (log) fprintf(log, "%ld\n", seen), fclose(log);
}

static int below(const char *path) { return *root && !strncmp(path, root, strlen(root)); }

static int place(int fd) {
    for (int i = count - 1; i >= 0; i--)
        if (files[i].fd == fd) return i;
    return -1;
}

static int move(const char *from, const char *to) { return REAL(rename, int (*)(const char *, const char *))(from, to); }

/* Notes that `to` is about to be replaced by `from`, or removed. */
static void note(const char *from, const char *to) {
    if (strcmp(kind, "power") || changed == MOST || strlen(from) >= 1024 || strlen(to) >= 1024) return;
    strcpy(changes[changed].from, from);
    strcpy(changes[changed].to, to);
    snprintf(changes[changed].kept, 1024, "%.900s-kept-%d-%d", root, (int)getpid(), changed);
    if (link(to, changes[changed].kept)) changes[changed].kept[0] = 0;
    changed++;
}

/* What happened in `folder` is safe, and in folders that were removed from it. */
static void settled(const char *folder) {
    size_t length = strlen(folder);
    for (int i = changed - 1; i >= 0; i--) {
        const char *to = changes[i].to;
        if (strncmp(to, folder, length) || to[length] != '/' || strchr(to + length + 1, '/')) continue;
        if (!strcmp(changes[i].from, "/")) settled(to);
        changes[i].to[0] = 0;
    }
}

static void die(void) {
    if (!strcmp(kind, "power")) {
        for (int i = 0; i < count; i++) REAL(truncate, int (*)(const char *, off_t))(files[i].path, files[i].safe);
        for (int i = changed - 1; i >= 0; i--) {
            if (!changes[i].to[0]) continue;
            if (!strcmp(changes[i].from, "/"))
                REAL(mkdir, int (*)(const char *, mode_t))(changes[i].to, 0777);
            else if (changes[i].from[0])
                move(changes[i].to, changes[i].from);
            if (changes[i].kept[0]) move(changes[i].kept, changes[i].to);
        }
    }
    kill(getpid(), SIGKILL);
    for (;;) pause();
}

/* Whether this operation fails; errno is set then. */
static int due(void) {
    long n = __atomic_add_fetch(&seen, 1, __ATOMIC_SEQ_CST);
    int full = !strcmp(kind, "full");
    if (!at || n < at || (n > at && !full)) return 0;
    if (!strcmp(kind, "interrupt")) return raise(SIGINT), 0;
    errno = full ? ENOSPC : EIO;
    return 1;
}

static int fatal(void) { return !strcmp(kind, "kill") || !strcmp(kind, "power"); }
static int failing(void) {
    if (!due()) return 0;
    if (fatal()) die();
    return 1;
}

static int opened(int fd, const char *path, int flags) {
    if (fd >= 0 && count < MOST && strlen(path) < sizeof files[0].path) {
        struct stat found;
        int old = fstat(fd, &found) == 0 && !(flags & O_TRUNC);
        for (int i = 0; i < count; i++)
            if (!strcmp(files[i].path, path)) files[i].path[0] = 0;
        strcpy(files[count].path, path);
        files[count].safe = old ? found.st_size : 0;
        files[count++].fd = fd;
    }
    return fd;
}

/* `path` in the open folder `dir`. */
static const char *whole(int dir, const char *path, char *place) {
    if (path[0] == '/' || dir <= 0 || dir >= 64 || folders[dir].fd != dir) return path;
    snprintf(place, 2048, "%s/%s", folders[dir].path, path);
    return place;
}

static int open_any(const char *name, int dir, const char *given, int flags, mode_t mode) {
    int (*real)(int, const char *, int, ...) = REAL(openat64, int (*)(int, const char *, int, ...));
    char place[2048];
    const char *path = whole(dir, given, place);
    (void)name;
    if ((flags & O_ACCMODE) == O_RDONLY || !below(path)) {
        int fd = real(dir, given, flags, mode);
        struct stat found;
        if (fd >= 0 && fd < 64 && below(path) && strlen(path) < 1024 && fstat(fd, &found) == 0 && S_ISDIR(found.st_mode)) {
            folders[fd].fd = fd;
            strcpy(folders[fd].path, path);
        }
        return fd;
    }
    return failing() ? -1 : opened(real(dir, given, flags, mode), path, flags);
}

#define OPEN(name, ...) \
    { mode_t mode = 0; va_list rest; va_start(rest, flags); \
      if (flags & O_CREAT) mode = va_arg(rest, mode_t); \
      va_end(rest); return open_any(#name, __VA_ARGS__, path, flags, mode); }
int open(const char *path, int flags, ...) OPEN(open, AT_FDCWD)
int open64(const char *path, int flags, ...) OPEN(open64, AT_FDCWD)
int openat(int dir, const char *path, int flags, ...) OPEN(openat, dir)
int openat64(int dir, const char *path, int flags, ...) OPEN(openat64, dir)

ssize_t write(int fd, const void *data, size_t size) {
    ssize_t (*real)(int, const void *, size_t) = REAL(write, ssize_t (*)(int, const void *, size_t));
    if (place(fd) < 0 || !due()) return real(fd, data, size);
    int error = errno;
    if (size > 1) (void)!real(fd, data, size / 2);
    if (fatal()) die();
    return errno = error, -1;
}

ssize_t writev(int fd, const struct iovec *parts, int number) {
    if (place(fd) < 0) return REAL(writev, ssize_t (*)(int, const struct iovec *, int))(fd, parts, number);
    for (int i = 0; i < number; i++)
        if (parts[i].iov_len) return write(fd, parts[i].iov_base, parts[i].iov_len);
    return 0;
}

static int synced(int fd, int (*real)(int)) {
    int i = place(fd);
    struct stat found;
    if (i < 0 && fd > 0 && fd < 64 && folders[fd].fd == fd) {
        if (failing()) return -1;
        settled(folders[fd].path);
    }
    if (i < 0) return real(fd);
    if (failing()) return -1;
    if (fstat(fd, &found) == 0) files[i].safe = found.st_size;
    return real(fd);
}
int fsync(int fd) { return synced(fd, REAL(fsync, int (*)(int))); }
int fdatasync(int fd) { return synced(fd, REAL(fdatasync, int (*)(int))); }

int close(int fd) {
    int i = place(fd);
    if (i >= 0) files[i].fd = -1;
    if (fd > 0 && fd < 64) folders[fd].fd = 0;
    return REAL(close, int (*)(int))(fd);
}

int ftruncate64(int fd, off64_t size) {
    if (place(fd) >= 0 && failing()) return -1;
    return REAL(ftruncate64, int (*)(int, off64_t))(fd, size);
}

int rename(const char *from, const char *to) {
    if (below(to) && failing()) return -1;
    if (below(to)) note(from, to);
    int done = move(from, to);
    if (below(to) && done && !strcmp(kind, "power") && changed) changed--;
    for (int i = 0; done == 0 && i < count; i++) {
        size_t length = strlen(from);
        if (!strcmp(files[i].path, to)) files[i].path[0] = 0;
        if (strncmp(files[i].path, from, length) || (files[i].path[length] && files[i].path[length] != '/')) continue;
        char moved[2048];
        snprintf(moved, sizeof moved, "%s%s", to, files[i].path + length);
        snprintf(files[i].path, sizeof files[i].path, "%.1023s", moved);
    }
    return done;
}

int unlink(const char *path) {
    if (below(path) && failing()) return -1;
    if (below(path)) note("", path);
    return REAL(unlink, int (*)(const char *))(path);
}

/* Whole folders are removed by these. */
int unlinkat(int dir, const char *given, int flags) {
    char place[2048];
    const char *path = whole(dir, given, place);
    if (below(path) && failing()) return -1;
    if (below(path)) note(flags & AT_REMOVEDIR ? "/" : "", path);
    return REAL(unlinkat, int (*)(int, const char *, int))(dir, given, flags);
}

int rmdir(const char *path) {
    if (below(path) && failing()) return -1;
    if (below(path)) note("/", path);
    return REAL(rmdir, int (*)(const char *))(path);
}

int mkdir(const char *path, mode_t mode) {
    if (below(path) && failing()) return -1;
    return REAL(mkdir, int (*)(const char *, mode_t))(path, mode);
}
