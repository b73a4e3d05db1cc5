/* What Rust's standard library expects of wasi-libc and Debian's version of it does not have yet. Only `cargo xtask web` with
   Debian's toolchain links this. There are no threads and no permissions in a browser, and no links between files. */

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int *__errno_location(void) { return &errno; }

int pthread_attr_init(void *attributes) { (void)attributes; return 0; }
int pthread_attr_destroy(void *attributes) { (void)attributes; return 0; }
int pthread_attr_setstacksize(void *attributes, size_t size) { (void)attributes; (void)size; return 0; }
int pthread_create(void *thread, const void *attributes, void *(*begin)(void *), void *with) {
  (void)thread; (void)attributes; (void)begin; (void)with;
  return ENOSYS;
}
int pthread_detach(void *thread) { (void)thread; return ENOSYS; }
int pthread_join(void *thread, void **result) { (void)thread; (void)result; return ENOSYS; }

int fchmod(int file, mode_t mode) { (void)file; (void)mode; return 0; }

/* The path from the root without `.`, `..` and doubled slashes; the working folder is the root. */
char *realpath(const char *path, char *resolved) {
  struct stat found;
  if (stat(path, &found) != 0) return NULL;
  char *to = resolved ? resolved : malloc(strlen(path) + 2);
  if (!to) return NULL;
  size_t length = 0;
  for (const char *part = path; *part;) {
    size_t size = strcspn(part, "/");
    if (size == 2 && part[0] == '.' && part[1] == '.') {
      while (length > 0 && to[--length] != '/') {}
    } else if (size > 0 && !(size == 1 && part[0] == '.')) {
      to[length++] = '/';
      memcpy(to + length, part, size);
      length += size;
    }
    part += size + (part[size] == '/');
  }
  if (length == 0) to[length++] = '/';
  to[length] = '\0';
  return to;
}
