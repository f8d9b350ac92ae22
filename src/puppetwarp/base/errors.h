#pragma once

#include <stdexcept>
#include <string>

namespace puppetwarp {

//! What every failure of puppetwarp tells a person: what it is about, why it failed, what can be done.
//! `what()` reads `WHAT: why (what to do)`, on one line.
class Error : public std::runtime_error {
public:
    //! \param subject  the file, handle or option that is at fault.
    //! \param reason   why it cannot be used.
    //! \param advice   what the person can do about it; empty when there is nothing to say.
    Error(const std::string& subject, const std::string& reason, const std::string& advice = {});

    const std::string& subject() const noexcept { return subject_; }
    const std::string& reason() const noexcept { return reason_; }
    const std::string& advice() const noexcept { return advice_; }

private:
    std::string subject_;
    std::string reason_;
    std::string advice_;
};

//! The input or the usage is at fault (exit code 2 of the command).
class InvalidInput : public Error {
public:
    using Error::Error;
};

//! The program or the machine is at fault: disk full, out of memory (exit code 3 of the command).
class MachineFault : public Error {
public:
    using Error::Error;
};

}  // namespace puppetwarp
