// `lightwell devices`: the OpenCL devices of this machine, measured on request.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli.h"
#include "open_device.h"

namespace cli {
namespace {

constexpr double kGigabyte = 1e9;

struct Probe {
    LWDeviceInfo info;
    LWRoofline roofline;
};

// The index of lwDescribeDevice as a name that openDevice understands: its name is unique, or the
// first of several alike is measured.
Probe probeDevice(const LWDeviceInfo& described) {
    lightwell::Device device = openDevice(described.name, 0);
    return {device.info(), device.probe()};
}

nlohmann::ordered_json toJson(const LWDeviceInfo& info, const std::optional<Probe>& probe) {
    nlohmann::ordered_json json{{"name", info.name},
                                {"platform", info.platform},
                                {"driver", info.driver},
                                {"opencl", info.openclVersion},
                                {"type", info.isGpu != 0 ? "gpu" : "cpu"},
                                {"compute_units", info.computeUnits},
                                {"memory_bytes", info.globalMemoryBytes},
                                {"shares_host_memory", info.hostUnifiedMemory != 0}};
    if (probe) {
        json["width"] = probe->info.width;
        json["multiply_add_gflops"] = probe->roofline.multiplyAddGflops;
        json["bandwidth_GBps"] = probe->roofline.bandwidthGBps;
        json["launch_us"] = probe->roofline.launchMicroseconds;
    }
    return json;
}

void printText(std::uint32_t index, const LWDeviceInfo& info, const std::optional<Probe>& probe) {
    fmt::print("{}  {}\n   {}, driver {}, {}\n   {}, {} compute units, {:.1f} GB{}\n", index, info.name,
               info.platform, info.driver, info.openclVersion, info.isGpu != 0 ? "GPU" : "CPU",
               info.computeUnits, double(info.globalMemoryBytes) / kGigabyte,
               info.hostUnifiedMemory != 0 ? ", shares memory with the host" : "");
    if (probe)
        fmt::print("   width {}, multiply-add {:.1f} Gflop/s, bandwidth {:.1f} GB/s, launch {:.1f} us\n",
                   probe->info.width, probe->roofline.multiplyAddGflops, probe->roofline.bandwidthGBps,
                   probe->roofline.launchMicroseconds);
}

void listDevices(bool asJson, bool isProbed) {
    std::uint32_t count = 0;
    lightwell::check(lwCountDevices(&count));
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDeviceInfo info = lightwell::make<LWDeviceInfo>();
        lightwell::check(lwDescribeDevice(i, &info));
        std::optional<Probe> probe;
        if (isProbed) probe = probeDevice(info);
        if (asJson)
            list.push_back(toJson(info, probe));
        else
            printText(i, info, probe);
    }
    if (asJson) fmt::print("{}\n", list.dump(2));
    if (count == 0) throw std::runtime_error("no OpenCL device; install a driver, e.g. pocl-opencl-icd");
}

}  // namespace

void addDevices(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("devices", "List the OpenCL devices that techniques can run on");
    auto asJson = std::make_shared<bool>(false);
    auto isProbed = std::make_shared<bool>(false);
    command->add_flag("--json", *asJson, "A JSON array, one object per device, on stdout");
    command->add_flag(
        "--probe", *isProbed,
        "Measure each (under two seconds): width in lanes per work-item, multiply-add rate in "
        "Gflop/s (a multiply-add counts two), bandwidth in GB/s, launch in microseconds");
    command->callback([asJson, isProbed] { listDevices(*asJson, *isProbed); });
}

}  // namespace cli
