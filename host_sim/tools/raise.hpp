// How an error ends what is being done: by an exception or, in a build without exceptions, by a call that does not
// return.
#pragma once

namespace tumble::host {

#if defined(__cpp_exceptions)

// Throws the error.
template <class Error>
[[noreturn]] void raise(const Error& error) {
    throw error;
}

#else

// Of the program: takes the message.
[[noreturn]] void end_with(const char* message);

template <class Error>
[[noreturn]] void raise(const Error& error) {
    end_with(error.what());
}

#endif

}  // namespace tumble::host
