#include "passes/phantom_vpl.h"

#include <cstddef>

#include "compute/device.h"

namespace lightwell {

PhantomVpl::PhantomVpl(Device& device)
    : device_(device),
      make_(device.programs().kernel("phantom_vpl/phantom_vpl", "phantom_vpl_make")),
      opposite_(device.programs().kernel("phantom_vpl/phantom_vpl", "phantom_vpl_opposite")) {}

void PhantomVpl::record(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                        const Buffer& lit, const Planes& texels, lw_phantom_options options,
                        const LightList& list) {
    const auto phantoms = std::uint32_t(frame.phantomCount);
    options.lists = cl_int(list.lists());
    options.keep = known_ == phantoms ? 1 : 0;
    if (kept_.moves(executor))
        kept_.move(executor, states_, {known_, offsetof(lw_phantom_state, position) / sizeof(float), sizeof(lw_phantom_state) / sizeof(float)});
    kept_.arrive(executor);
    if (phantoms) {
        states_.reserve(device_, phantoms * sizeof(lw_phantom_state), "states of phantom VPLs");
        Planes known = texels;
        if (!known) known.memory = inputs.get();  // every place comes from the host
        executor.run("phantom_vpl.make", make_, {phantoms, 1}, {1, 1}, inputs, frame, lit, known,
                     options, states_, list.order(), list.vpls(), list.baked());
    }
    known_ = phantoms;
    if (options.opposite)
        executor.run("phantom_vpl.opposite", opposite_, {1, 1}, {1, 1}, frame, options, list.order(),
                     list.vpls(), list.baked());
}

std::uint64_t PhantomVpl::estimateBytes(std::uint32_t phantoms) {
    return phantoms * sizeof(lw_phantom_state);
}

}  // namespace lightwell
