// Replays a scene and writes every recorded state: lines "state STEP WORD ..." in hex, before one of them the sticky
// status where it has changed, "status ISSUE ...", and at the end that and the digest, "end [ISSUE ...] HASH".
#include "port.hpp"

#include "recording.hpp"

namespace {

using Scene = tumble::Replay<RecordedScene::Config, RecordedScene>;

// Collects text, because each write to the debugger costs a stop.
class Writer {
public:
    void text(std::string_view text) {
        for (const char c : text) put(c);
    }
    void hex(std::uint32_t word) {
        for (int shift = 28; shift >= 0; shift -= 4) put("0123456789abcdef"[(word >> shift) & 15]);
    }
    void flush() {
        tumble::port::write(buffer_, size_);
        size_ = 0;
    }

private:
    void put(char c) {
        buffer_[size_++] = c;
        if (size_ == sizeof buffer_) flush();
    }
    char buffer_[256]{};
    std::size_t size_ = 0;
};

// Set up before main() runs, so that the deepest part of the set-up has the stack for itself.
Scene scene;
Writer out;

// The names of its issues, each with a space behind it.
void write(tumble::Status status) {
    for (const tumble::Issue issue : tumble::all_issues) {
        if (!status.has(issue)) continue;
        out.text(tumble::name_of(issue));
        out.text(" ");
    }
}

void record() {
    static std::uint8_t told = 0;
    const tumble::Status status = scene.world().status();
    if (status.bits != told) {
        out.text("status ");
        write(status);
        out.text("\n");
        told = status.bits;
    }
    out.text("state ");
    out.hex(scene.world().steps_taken());
    for (int b = 0; b < scene.world().body_count(); ++b) {
        tumble::for_each_word(
            scene.world().state(tumble::BodyId{b}),
            [](std::uint32_t word) {
                out.text(" ");
                out.hex(word);
            },
            scene.world().bodies().rotates(b));
    }
    out.text("\n");
    out.flush();  // nothing is left half said if the next step ends in a fault
}

}  // namespace

int main() {
    tumble::port::init();
    record();
    tumble::Status status = scene.world().status();
    std::uint32_t until_record = record_every;
    for (std::uint32_t step = 1; step <= RecordedScene::steps && !status.has(tumble::Issue::range_left); ++step) {
        status = scene.step();
        if (--until_record == 0 || step == RecordedScene::steps || status.has(tumble::Issue::range_left)) {
            record();
            until_record = record_every;
        }
    }
    out.text("end ");
    write(status);
    const std::uint64_t hash = scene.world().hash();
    out.hex(static_cast<std::uint32_t>(hash >> 32));
    out.hex(static_cast<std::uint32_t>(hash));
    out.text("\n");
    out.flush();
    tumble::port::exit(0);
}
