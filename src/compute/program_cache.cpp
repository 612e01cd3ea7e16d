// Programs: one build per source, options and device, kept in memory and as a binary on disk.
#include <cstring>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/program.h"

namespace lightwell {
namespace {

// LW_HAS_FMA: the device says that it fuses in hardware. PoCL does so without defining FP_FAST_FMAF, and
// its mad() is then a multiplication and an addition, slower and rounded twice.
std::string buildOptions(const Defines& defines, std::uint32_t width, bool fma) {
    std::string options = "-cl-std=CL1.2 -DLW_WIDTH=" + std::to_string(width);
    if (fma) options += " -DLW_HAS_FMA";
    for (const auto& [name, value] : defines) options += " -D" + name + "=" + value;
    return options;
}

std::string buildLog(cl_program program, cl_device_id device) {
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    if (size) clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    while (!log.empty() && (log.back() == '\0' || log.back() == '\n' || log.back() == ' '))
        log.pop_back();
    return log;
}

// A file on disk holds the launches its binary was saved after, one a line, a zero, and the binary.
BinaryStore::Bytes pack(const std::set<std::string>& launches, const BinaryStore::Bytes& binary) {
    BinaryStore::Bytes bytes;
    for (const std::string& launch : launches) {
        bytes.insert(bytes.end(), launch.begin(), launch.end());
        bytes.push_back('\n');
    }
    bytes.push_back(0);
    bytes.insert(bytes.end(), binary.begin(), binary.end());
    return bytes;
}

bool unpack(const BinaryStore::Bytes& bytes, std::set<std::string>& launches,
            BinaryStore::Bytes& binary) {
    std::string line;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (bytes[i] == 0) {
            binary.assign(bytes.begin() + std::ptrdiff_t(i) + 1, bytes.end());
            return !binary.empty();
        }
        if (bytes[i] != '\n') {
            line += char(bytes[i]);
        } else {
            launches.insert(line);
            line.clear();
        }
    }
    return false;
}

}  // namespace

bool Kernel::noteLaunch(const std::array<std::size_t, 2>& global,
                        const std::array<std::size_t, 2>& local) {
    const bool wide = global[0] / local[0] > 65535 || global[1] / local[1] > 65535;
    if (!launches_.insert({local[0], local[1], std::size_t(wide)}).second) return false;
    programLaunches_->insert(name_ + ' ' + std::to_string(local[0]) + 'x' + std::to_string(local[1]) +
                             (wide ? " wide" : ""));
    return true;
}

struct ProgramCache::Program {
    std::string name, source, options;
    std::uint32_t width = 0;
    StoreKey key;
    cl_program program = nullptr;
    std::map<std::string, Kernel> kernels;
    std::set<std::string> launches;       // by any process so far, as far as this one knows
    std::set<std::string> savedLaunches;  // of the file on disk

    ~Program() {
        for (auto& [kernelName, kernel] : kernels)
            if (kernel.kernel_) clReleaseKernel(kernel.kernel_);
        if (program) clReleaseProgram(program);
    }
};

ProgramCache::ProgramCache(Device& device, std::string directory)
    : device_(device), store_(std::move(directory)) {}

ProgramCache::~ProgramCache() = default;

void ProgramCache::addSource(const std::string& program, std::string source) {
    added_[program] = std::move(source);
}

Kernel& ProgramCache::kernel(const std::string& programName, const std::string& kernelName,
                             const Defines& defines, std::uint32_t width) {
    Program& owner = program(programName, defines, width ? width : device_.width());
    const auto found = owner.kernels.find(kernelName);
    if (found != owner.kernels.end()) return found->second;

    cl_int status = CL_SUCCESS;
    cl_kernel created = clCreateKernel(owner.program, kernelName.c_str(), &status);
    if (status == CL_INVALID_KERNEL_NAME)
        fail(LW_ERROR_INTERNAL, "program ", programName, " has no kernel \"", kernelName, "\"");
    checkCl(status, "clCreateKernel");
    Kernel& kernel = owner.kernels[kernelName];
    kernel.name_ = kernelName;
    kernel.width_ = owner.width;
    kernel.kernel_ = created;
    kernel.programLaunches_ = &owner.launches;
    checkCl(clGetKernelInfo(created, CL_KERNEL_NUM_ARGS, sizeof kernel.argumentCount_,
                            &kernel.argumentCount_, nullptr),
            "clGetKernelInfo(CL_KERNEL_NUM_ARGS)");
    return kernel;
}

ProgramCache::Program& ProgramCache::program(const std::string& name, const Defines& defines,
                                             std::uint32_t width) {
    const std::string options = buildOptions(defines, width, device_.hasFma());
    std::unique_ptr<Program>& slot = programs_[name + '\n' + options];
    if (slot) return *slot;

    auto made = std::make_unique<Program>();
    made->name = name;
    made->options = options;
    made->width = width;
    const auto added = added_.find(name);
    made->source = added != added_.end() ? added->second : programSource(name);
    made->key = hashKey({"program", made->source, options, device_.identity()});
    if (!load(*made)) build(*made);
    slot = std::move(made);
    return *slot;
}

void ProgramCache::build(Program& program) {
    const char* text = program.source.c_str();
    const std::size_t size = program.source.size();
    cl_int status = CL_SUCCESS;
    program.program = clCreateProgramWithSource(device_.context(), 1, &text, &size, &status);
    checkCl(status, "clCreateProgramWithSource");
    cl_device_id id = device_.id();
    status = clBuildProgram(program.program, 1, &id, program.options.c_str(), nullptr, nullptr);
    const std::string log = buildLog(program.program, id);
    if (status != CL_SUCCESS)
        fail(LW_ERROR_BUILD_FAILED, "kernel ", program.name, " does not build (", clErrorName(status),
             ") with options \"", program.options, "\":\n", log);
    if (!log.empty()) device_.log(LW_LOG_INFO, "kernel " + program.name + ": " + log);
    ++built_;
}

bool ProgramCache::load(Program& program) {
    BinaryStore::Bytes bytes, binary;
    const BinaryStore::Found found = store_.read(program.key, bytes);
    if (found == BinaryStore::Found::kNo) return false;
    std::set<std::string> launches;
    if (found == BinaryStore::Found::kDamaged || !unpack(bytes, launches, binary)) {
        device_.log(LW_LOG_WARNING, "cache: " + store_.path(program.key) + " is damaged; kernel " +
                                        program.name + " is built again");
        return false;
    }
    cl_device_id id = device_.id();
    const unsigned char* data = binary.data();
    const std::size_t size = binary.size();
    cl_int accepted = CL_SUCCESS, status = CL_SUCCESS;
    cl_program loaded =
        clCreateProgramWithBinary(device_.context(), 1, &id, &size, &data, &accepted, &status);
    if (status == CL_SUCCESS && accepted == CL_SUCCESS)
        status = clBuildProgram(loaded, 1, &id, program.options.c_str(), nullptr, nullptr);
    if (status != CL_SUCCESS || accepted != CL_SUCCESS) {
        if (loaded) clReleaseProgram(loaded);
        device_.log(LW_LOG_WARNING, "cache: the driver refuses " + store_.path(program.key) +
                                        "; kernel " + program.name + " is built again");
        return false;
    }
    program.program = loaded;
    program.launches = launches;
    program.savedLaunches = std::move(launches);
    ++loaded_;
    return true;
}

void ProgramCache::saveBinaries() {
    if (!store_.enabled()) return;
    for (auto& [key, program] : programs_)
        if (program && program->launches != program->savedLaunches) save(*program);
}

void ProgramCache::save(Program& program) {
    program.savedLaunches = program.launches;  // a failure is not tried again at every frame
    cl_uint devices = 0;
    clGetProgramInfo(program.program, CL_PROGRAM_NUM_DEVICES, sizeof devices, &devices, nullptr);
    std::vector<cl_device_id> ids(devices);
    std::vector<std::size_t> sizes(devices);
    clGetProgramInfo(program.program, CL_PROGRAM_DEVICES, devices * sizeof ids[0], ids.data(), nullptr);
    cl_int status = clGetProgramInfo(program.program, CL_PROGRAM_BINARY_SIZES, devices * sizeof sizes[0],
                                     sizes.data(), nullptr);
    std::size_t mine = devices;
    for (std::size_t i = 0; i < devices; ++i)
        if (ids[i] == device_.id()) mine = i;
    if (status != CL_SUCCESS || mine == devices || sizes[mine] == 0) {
        device_.log(LW_LOG_INFO, "cache: the driver gives no binary of kernel " + program.name);
        return;
    }
    // One destination per device of an adopted context; the others' binaries are not wanted.
    BinaryStore::Bytes binary(sizes[mine]);
    std::vector<unsigned char*> targets(devices, nullptr);
    targets[mine] = binary.data();
    status = clGetProgramInfo(program.program, CL_PROGRAM_BINARIES, devices * sizeof targets[0],
                              targets.data(), nullptr);
    if (status != CL_SUCCESS) {
        device_.log(LW_LOG_INFO, "cache: the driver gives no binary of kernel " + program.name);
        return;
    }
    if (const auto problem = store_.write(program.key, pack(program.launches, binary)))
        device_.warnOfCache(*problem);
}

}  // namespace lightwell
