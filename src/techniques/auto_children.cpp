#include "techniques/auto_children.h"

#include <utility>

namespace lightwell {

void AutoChild::update(Executor& executor, const LWFrame& frame, std::uint32_t inputs) {
    LWFrame own = frame;
    if (hasMissedReset_) own.reset = 1;
    technique_->update(executor, own);
    isBack_ = hasUpdated_ && hasMissed_;
    hasUpdated_ = true;
    hasMissed_ = hasMissedReset_ = false;
    inputs_ = inputs;
}

void AutoChild::render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    LWGBuffer own = gbuffer;
    // Motion vectors lead to the frame before, which it has not seen: its history is followed by the cameras.
    if (isBack_) own.motion = LWImage{};
    technique_->render(executor, view, own, output);
    hasRendered_ = true;
    accepted_ = inputs_;
}

void AutoChild::miss(bool isReset) {
    hasMissed_ = true;
    hasMissedReset_ |= isReset;
}

void AutoChildren::start(std::unique_ptr<AutoChild> child) {
    if (running_) resting_ = std::move(running_);
    running_ = std::move(child);
}

std::unique_ptr<AutoChild> AutoChildren::takeResting(std::size_t candidate) {
    if (!resting_ || resting_->candidate() != candidate) return nullptr;
    return std::move(resting_);
}

void AutoChildren::fallBack() { running_ = std::move(resting_); }

void AutoChildren::lose() {
    if (running_) running_->technique().lose();
    if (resting_) resting_->technique().lose();
}

std::uint64_t AutoChildren::bytes() const {
    return (running_ ? running_->technique().bytes() : 0) + (resting_ ? resting_->technique().bytes() : 0);
}

}  // namespace lightwell
