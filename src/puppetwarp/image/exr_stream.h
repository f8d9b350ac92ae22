#pragma once

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/base/progress.h>

#include <puppetwarp/image/picture_file.h>
#include <puppetwarp/image/vips_decode.h>

#include <ImfIO.h>

#include <exception>
#include <new>
#include <string>

namespace puppetwarp {

//! What OpenEXR reads from, over an open file.
class ExrInput : public Imf::IStream {
public:
    explicit ExrInput(const PictureFile& file) : IStream(file.name().c_str()), file_(file) {}

    bool read(char bytes[], int count) override;
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    const PictureFile& file_;
    std::uint64_t position_ = 0;
};

//! What OpenEXR writes to. Keeps the first failure: OpenEXR swallows what is thrown while it closes a file.
class ExrOutput : public Imf::OStream {
public:
    explicit ExrOutput(OutputFile& file) : OStream(file.target().c_str()), file_(file) {}

    void write(const char bytes[], int count) override;
    std::uint64_t tellp() override;
    void seekp(std::uint64_t position) override;
    void rethrow_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    OutputFile& file_;
    std::exception_ptr failure_;
};

//! What OpenEXR throws while it reads, as what puppetwarp throws.
template <typename Work>
auto reading_exr(const PictureFile& file, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw MachineFault(file.name(), "not enough memory to read it");
    } catch (const std::exception& error) {
        throw_damaged(file.name(), error.what());
    }
}

//! Does what writes to `stream` until the file is closed; what OpenEXR throws becomes what puppetwarp throws.
template <typename Work>
void writing_exr(const OutputFile& file, const ExrOutput& stream, const Work& work) {
    try {
        work();
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        stream.rethrow_failure();
        throw MachineFault(file.target().string(), std::string("cannot be written: ") + error.what());
    }
    stream.rethrow_failure();
}

}  // namespace puppetwarp
