# Flags of every target of this project, never of a consumer.
add_library(bespoke_flags INTERFACE)
target_compile_features(bespoke_flags INTERFACE cxx_std_20)
# Contraction would let results differ between the instruction sets that hot loops are compiled for.
target_compile_options(bespoke_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms on `"literal" + std::string` (GCC bug 105329).
  target_compile_options(bespoke_flags INTERFACE -Wno-restrict)
endif()
if(BESPOKE_WARNINGS_AS_ERRORS)
  target_compile_options(bespoke_flags INTERFACE -Werror)
endif()
if(BESPOKE_SANITIZE)
  target_compile_options(bespoke_flags INTERFACE -fsanitize=${BESPOKE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(bespoke_flags INTERFACE -fsanitize=${BESPOKE_SANITIZE})
  if(BESPOKE_SANITIZE MATCHES undefined)
    # Checks of every access, which double what Eigen costs to compile; the address sanitizer finds such pointers.
    target_compile_options(bespoke_flags INTERFACE -fno-sanitize=null,alignment,object-size)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Instrumented <regex> seems to read what nobody wrote (GCC bug 105562).
    target_compile_options(bespoke_flags INTERFACE -Wno-maybe-uninitialized)
    if(BESPOKE_SANITIZE MATCHES "thread")
      # And instrumented sums of strings, to write beyond their ends.
      target_compile_options(bespoke_flags INTERFACE -Wno-array-bounds -Wno-stringop-overflow)
    endif()
  endif()
endif()
