/* Makes the printing of another program a no-op (LD_PRELOAD), so that what is timed is its reading and
   interpreting. */
#include <stdarg.h>
#include <stdio.h>

int fprintf(FILE *stream, const char *format, ...) { (void)stream; (void)format; return 1; }
int vfprintf(FILE *stream, const char *format, va_list list) { (void)stream; (void)format; (void)list; return 1; }
int __fprintf_chk(FILE *stream, int flag, const char *format, ...) {
  (void)stream; (void)flag; (void)format; return 1;
}
int __vfprintf_chk(FILE *stream, int flag, const char *format, va_list list) {
  (void)stream; (void)flag; (void)format; (void)list; return 1;
}
