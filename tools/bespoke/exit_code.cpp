#include "exit_code.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "bespoke/error.h"
#include "bespoke/unknown_ending.h"
#include "interruption.h"

namespace bespoke::command {
namespace {

int fail(ExitCode code, const char* message) {
  std::fprintf(stderr, "bespoke: %s\n", message);
  return code;
}

}  // namespace

int exit_code_of(const std::function<void()>& body) {
  try {
    body();
    return done;
  } catch (const CLI::ParseError& error) {
    return fail(wrong_arguments, error.what());
  } catch (const Interrupted& error) {
    fail(done, error.what());
    return 128 + interruption();
  } catch (const UnknownEnding& error) {
    return fail(wrong_arguments, error.what());
  } catch (const InvalidInput& error) {
    return fail(bad_input, error.what());
  } catch (const FormatError& error) {
    return fail(bad_input, error.what());
  } catch (const SolverError& error) {
    return fail(fit_failed, error.what());
  } catch (const Error& error) {
    return fail(file_or_memory_trouble, error.what());
  } catch (const std::bad_alloc&) {
    return fail(file_or_memory_trouble,
                "out of memory; a larger --voxel-size, --tolerance or --lambda needs less");
  } catch (const std::exception& error) {
    return fail(file_or_memory_trouble, error.what());
  }
}

}  // namespace bespoke::command
