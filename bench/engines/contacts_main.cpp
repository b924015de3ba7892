// The contest of contacts for the contenders that the function TUMBLE_CONTENDERS adds.
#include "contacts.hpp"

int main(int argc, char** argv) {
    std::vector<tumble::bench::Contender> contenders;
    tumble::bench::TUMBLE_CONTENDERS(contenders);
    return tumble::bench::contact_contest(argc, argv, contenders);
}
