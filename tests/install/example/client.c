// A command to `photorque serve`, sealed.
#include <photorque_serve.h>

int main(void) {
  photorque_command_packet command = {0};
  photorque_seal(&command.header, PHOTORQUE_COMMAND, sizeof command);
  return command.header.size == 72 && sizeof(photorque_measurement_packet) == 256 ? 0 : 1;
}
