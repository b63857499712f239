/*
 * Preloaded into user-mode Linux on processors with AMX. User-mode Linux keeps the x86 extended state in a buffer that is
 * too small for theirs; it reads what fits, but the host's kernel refuses to write back less than all
 * (PTRACE_SETREGSET, NT_X86_XSTATE), and user-mode Linux panics. Here the rest is filled in from the traced process's
 * present state before the write. Built by toolchain/vcan/vcan.sh.
 */
#define _GNU_SOURCE
#include <elf.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#ifndef NT_X86_XSTATE
#define NT_X86_XSTATE 0x202
#endif

enum { kLargestState = 64 * 1024 };

long ptrace(enum __ptrace_request request, ...) {
  va_list arguments;
  va_start(arguments, request);
  const pid_t pid = va_arg(arguments, pid_t);
  void* const address = va_arg(arguments, void*);
  void* data = va_arg(arguments, void*);
  va_end(arguments);

  static char state[kLargestState];  /* user-mode Linux has one thread */
  struct iovec whole = {state, sizeof state};
  if (request == PTRACE_SETREGSET && address == (void*)NT_X86_XSTATE) {
    const struct iovec* given = data;
    if (syscall(SYS_ptrace, PTRACE_GETREGSET, pid, address, &whole) == 0 && given->iov_len < whole.iov_len) {
      memcpy(state, given->iov_base, given->iov_len);
      data = &whole;
    }
  }
  /* The kernel returns the word that a PEEK reads through a pointer; the C library's function returns it itself. */
  long word = 0;
  const int peeks = request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER;
  const long result = syscall(SYS_ptrace, request, pid, address, peeks ? (void*)&word : data);
  return peeks && result == 0 ? word : result;
}
