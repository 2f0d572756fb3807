/* Library to preload: one call of libc fails in the program, as the environment says.
 *
 *   FAILING_CALL      its name below; "alloc" is every allocation
 *   FAILING_AT        which one, from 1; 0: none, they are counted
 *   FAILING_FOR_GOOD  set: every later one, too
 *   FAILING_ERRNO     the error; 0 for write and read: half of the bytes only
 *   FAILING_COUNT     file for the number of calls, written at the end
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

ssize_t readlink(const char *, char *, size_t);

static const char *chosen;
static long at, error;
static int for_good;
static atomic_long calls;

__attribute__((constructor)) static void begin(void) {
  const char *text = getenv("FAILING_AT");
  at = text ? atol(text) : 0;
  text = getenv("FAILING_ERRNO");
  error = text ? atol(text) : 0;
  for_good = getenv("FAILING_FOR_GOOD") != NULL;
  chosen = getenv("FAILING_CALL");
}

static int fails(const char *name) {
  if (!chosen || strcmp(name, chosen)) return 0;
  long count = ++calls;
  if (!at || (for_good ? count < at : count != at)) return 0;
  errno = (int)error;
  return 1;
}

/* Files of the kernel, in which the number of cores is looked up: num_cpus 1.17 never ends where reading them fails for good. */
static int is_of_kernel(int file) {
  char link[32] = "/proc/self/fd/", path[8] = "", *digit = link + 14;
  if (file < 0 || file > 99) return 0;
  if (file > 9) *digit++ = (char)('0' + file / 10);
  *digit = (char)('0' + file % 10);
  if (readlink(link, path, 7) < 0) return 0;
  return !strncmp(path, "/proc/", 6) || !strncmp(path, "/sys/", 5);
}

#define REAL(type, name, parameters) \
  static type(*real) parameters;     \
  if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name)
#define CALL(type, name, parameters, arguments, failed) \
  type name parameters {                                \
    REAL(type, name, parameters);                       \
    return fails(#name) ? failed : real arguments;      \
  }
/* of those that may do half of what is asked for */
#define PARTIAL(name, buffer)                                    \
  ssize_t name(int file, buffer bytes, size_t size) {            \
    REAL(ssize_t, name, (int, buffer, size_t));                  \
    if ((for_good && is_of_kernel(file)) || !fails(#name)) return real(file, bytes, size); \
    return error ? -1 : real(file, bytes, size > 1 ? size / 2 : size); \
  }

PARTIAL(read, void *)
PARTIAL(write, const void *)
CALL(ssize_t, writev, (int f, const void *v, int n), (f, v, n), -1)
CALL(ssize_t, pread64, (int f, void *b, size_t n, off_t o), (f, b, n, o), -1)
CALL(ssize_t, pwrite64, (int f, const void *b, size_t n, off_t o), (f, b, n, o), -1)
CALL(int, open, (const char *p, int o, unsigned m), (p, o, m), -1)
CALL(int, open64, (const char *p, int o, unsigned m), (p, o, m), -1)
CALL(int, openat64, (int d, const char *p, int o, unsigned m), (d, p, o, m), -1)
CALL(int, fsync, (int f), (f), -1)
CALL(int, ftruncate64, (int f, off_t n), (f, n), -1)
CALL(int, flock, (int f, int o), (f, o), -1)
CALL(int, rename, (const char *a, const char *b), (a, b), -1)
CALL(int, unlink, (const char *p), (p), -1)
CALL(int, mkdir, (const char *p, unsigned m), (p, m), -1)
CALL(off_t, lseek64, (int f, off_t o, int w), (f, o, w), -1)
CALL(int, statx, (int d, const char *p, int o, unsigned m, void *s), (d, p, o, m, s), -1)
CALL(void *, opendir, (const char *p), (p), NULL)
CALL(void *, readdir64, (void *d), (d), NULL)
CALL(char *, realpath, (const char *p, char *r), (p, r), NULL)
CALL(void *, mmap64, (void *a, size_t n, int p, int g, int f, off_t o), (a, n, p, g, f, o), (void *)-1)
CALL(int, pthread_create, (void *t, const void *a, void *(*f)(void *), void *x), (t, a, f, x), (int)error)

/* dlsym itself allocates: these are asked for by their other names */
void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t), *__libc_memalign(size_t, size_t);
void *malloc(size_t n) { return fails("alloc") ? NULL : __libc_malloc(n); }
void *calloc(size_t n, size_t size) { return fails("alloc") ? NULL : __libc_calloc(n, size); }
void *realloc(void *p, size_t n) { return fails("alloc") ? NULL : __libc_realloc(p, n); }
int posix_memalign(void **p, size_t alignment, size_t n) {
  *p = fails("alloc") ? NULL : __libc_memalign(alignment, n);
  return *p ? 0 : ENOMEM;
}

__attribute__((destructor)) static void end(void) {
  const char *path = getenv("FAILING_COUNT");
  char digits[24], *digit = digits + sizeof digits;
  if (!path) return;
  for (long count = calls; count || digit == digits + sizeof digits; count /= 10) *--digit = (char)('0' + count % 10);
  chosen = NULL;
  int file = open(path, 01101 /* write, create, empty */, 0600);
  if (file >= 0 && write(file, digit, (size_t)(digits + sizeof digits - digit)) < 0) _Exit(99);
}
