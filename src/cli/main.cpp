#include "command.h"
#include "terminal.h"

int main(int argc, char** argv) {
    puppetwarp::cli::install_signal_handlers();
    return puppetwarp::cli::run(argc, argv);
}
