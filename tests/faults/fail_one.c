// LD_PRELOAD: one call of the system fails, the FAIL_CALL-th of those that concern a file below
// FAIL_FOLDER. Its name and its file are written to FAIL_LOG; nothing is where there are fewer.
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;
static long fail_call;
static char folder[PATH_MAX], log_file[PATH_MAX];

static void keep(char* text, const char* name) {
  const char* value = getenv(name);
  if (value != NULL) strncpy(text, value, PATH_MAX - 1);
}

__attribute__((constructor)) static void begin(void) {
  const char* number = getenv("FAIL_CALL");
  fail_call = number != NULL ? atol(number) : 0;
  keep(folder, "FAIL_FOLDER");
  keep(log_file, "FAIL_LOG");
  unsetenv("LD_PRELOAD");  // programs that this one starts are not counted
}

// The system itself, for what must not be counted.
static int say(const char* call, const char* file) {
  char line[2 * PATH_MAX];
  const int size = snprintf(line, sizeof line, "%s %s\n", call, file);
  const long log = syscall(SYS_openat, AT_FDCWD, log_file, O_WRONLY | O_CREAT | O_APPEND, 0666);
  const long written = log < 0 ? -1 : syscall(SYS_write, log, line, (size_t)size);
  if (log >= 0) syscall(SYS_close, log);
  return written < 0;
}

static int fails(const char* call, const char* file, int error) {
  char whole[PATH_MAX] = "";
  if (folder[0] == '\0' || file == NULL) return 0;
  if (file[0] != '/') {
    if (syscall(SYS_getcwd, whole, sizeof whole) < 0) return 0;
    strncat(whole, "/", sizeof whole - strlen(whole) - 1);
  }
  strncat(whole, file, sizeof whole - strlen(whole) - 1);
  if (strncmp(whole, folder, strlen(folder)) != 0) return 0;
  if (++calls != fail_call) return 0;
  say(call, whole);
  errno = error;
  return 1;
}

static int fails_at(const char* call, int descriptor, int error) {
  const int before = errno;
  char link[64], file[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const long size = syscall(SYS_readlinkat, AT_FDCWD, link, file, sizeof file - 1);
  errno = before;
  if (size <= 0) return 0;
  file[size] = '\0';
  return fails(call, file, error);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

#define BY_FILE(result, failed, error, name, file, parameters, arguments) \
  result name parameters {                                                \
    if (fails(#name, file, error)) return failed;                         \
    return REAL(name) arguments;                                          \
  }
#define BY_DESCRIPTOR(result, error, name, parameters, arguments) \
  result name parameters {                                        \
    if (fails_at(#name, fd, error)) return -1;                    \
    return REAL(name) arguments;                                  \
  }

#define OPEN(name)                                                  \
  int name(const char* file, int flags, ...) {                      \
    va_list rest;                                                   \
    va_start(rest, flags);                                          \
    const mode_t mode = (flags & O_CREAT) ? va_arg(rest, mode_t) : 0; \
    va_end(rest);                                                   \
    if (fails(#name, file, (flags & O_CREAT) ? ENOSPC : EMFILE)) return -1; \
    return REAL(name)(file, flags, mode);                           \
  }
OPEN(open)
OPEN(open64)

BY_FILE(FILE*, NULL, mode[0] == 'r' ? EMFILE : ENOSPC, fopen, file, (const char* file, const char* mode), (file, mode))
BY_FILE(FILE*, NULL, mode[0] == 'r' ? EMFILE : ENOSPC, fopen64, file, (const char* file, const char* mode), (file, mode))
BY_FILE(int, -1, EIO, rename, from, (const char* from, const char* to), (from, to))
BY_FILE(int, -1, EIO, unlink, file, (const char* file), (file))
BY_FILE(int, -1, EIO, remove, file, (const char* file), (file))
BY_FILE(int, -1, ENOSPC, mkdir, file, (const char* file, mode_t mode), (file, mode))
BY_FILE(int, -1, EIO, rmdir, file, (const char* file), (file))
BY_FILE(int, -1, EIO, truncate, file, (const char* file, off_t size), (file, size))
BY_FILE(DIR*, NULL, EMFILE, opendir, file, (const char* file), (file))
BY_FILE(int, -1, EIO, stat, file, (const char* file, struct stat* status), (file, status))
BY_FILE(int, -1, EIO, lstat, file, (const char* file, struct stat* status), (file, status))

BY_DESCRIPTOR(ssize_t, EIO, read, (int fd, void* to, size_t size), (fd, to, size))
BY_DESCRIPTOR(ssize_t, EIO, pread, (int fd, void* to, size_t size, off_t at), (fd, to, size, at))
BY_DESCRIPTOR(ssize_t, EIO, pread64, (int fd, void* to, size_t size, off64_t at), (fd, to, size, at))
BY_DESCRIPTOR(ssize_t, ENOSPC, write, (int fd, const void* from, size_t size), (fd, from, size))
BY_DESCRIPTOR(ssize_t, ENOSPC, pwrite, (int fd, const void* from, size_t size, off_t at), (fd, from, size, at))
BY_DESCRIPTOR(ssize_t, ENOSPC, pwrite64, (int fd, const void* from, size_t size, off64_t at), (fd, from, size, at))
BY_DESCRIPTOR(ssize_t, ENOSPC, writev, (int fd, const struct iovec* parts, int count), (fd, parts, count))
BY_DESCRIPTOR(int, EIO, fsync, (int fd), (fd))
BY_DESCRIPTOR(int, EIO, fdatasync, (int fd), (fd))
BY_DESCRIPTOR(int, EIO, ftruncate, (int fd, off_t size), (fd, size))
BY_DESCRIPTOR(int, EIO, ftruncate64, (int fd, off64_t size), (fd, size))
BY_DESCRIPTOR(int, EIO, fstat, (int fd, struct stat* status), (fd, status))
BY_DESCRIPTOR(off_t, EIO, lseek, (int fd, off_t at, int whence), (fd, at, whence))
BY_DESCRIPTOR(off64_t, EIO, lseek64, (int fd, off64_t at, int whence), (fd, at, whence))

// The descriptor is closed whatever close() says, as on Linux.
int close(int fd) {
  const int failed = fails_at("close", fd, EIO);
  const int result = REAL(close)(fd);
  if (!failed) return result;
  errno = EIO;
  return -1;
}

// What the C library calls within itself, past the names above.
int fclose(FILE* file) {
  const int failed = fails_at("fclose", fileno(file), ENOSPC);
  const int result = REAL(fclose)(file);
  if (!failed) return result;
  errno = ENOSPC;
  return EOF;
}
size_t fwrite(const void* from, size_t size, size_t count, FILE* file) {
  if (fails_at("fwrite", fileno(file), ENOSPC)) return 0;
  return REAL(fwrite)(from, size, count, file);
}
int fflush(FILE* file) {
  if (file != NULL && fails_at("fflush", fileno(file), ENOSPC)) return EOF;
  return REAL(fflush)(file);
}
