// The contest TUMBLE_CONTEST of the contenders that the function TUMBLE_CONTENDERS adds. It includes no header of a
// contest, since every program compiles it anew.
#include <vector>

namespace tumble::bench {

struct Contender;
struct Contest;
void TUMBLE_CONTENDERS(std::vector<Contender>& contenders);
Contest TUMBLE_CONTEST();
int run_contest(int argc, char** argv, void (*add)(std::vector<Contender>&), Contest (*contest)());

}  // namespace tumble::bench

int main(int argc, char** argv) {
    using namespace tumble::bench;
    return run_contest(argc, argv, TUMBLE_CONTENDERS, TUMBLE_CONTEST);
}
