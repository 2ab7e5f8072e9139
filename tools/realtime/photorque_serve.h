/* Packets between `photorque serve` and its clients, version 1. For C99 and C++, without a library.
 *
 * One UDP packet is one structure. Every number is little-endian, every double IEEE 754; there is
 * no padding. Times t are those of the simulation; *_ns are nanoseconds of the sender's
 * CLOCK_MONOTONIC. Lab: x east, y north, z up. Quaternions are w, x, y, z (Hamilton) and rotate
 * body vectors into the lab. docs/realtime.md describes the order of the packets. Fill in all
 * fields of a command before calling photorque_seal(). */
#ifndef PHOTORQUE_SERVE_H
#define PHOTORQUE_SERVE_H

#include <stddef.h>
#include <stdint.h>

#define PHOTORQUE_MAGIC 0x51525450u /* "PTRQ" */
#define PHOTORQUE_VERSION 1u
#define PHOTORQUE_PORT 4160

/* NOLINTBEGIN(modernize-use-using): the header is also valid C */

enum photorque_packet_kind {
  PHOTORQUE_HELLO = 1,       /* client: begins; only a header. The first measurement answers it */
  PHOTORQUE_COMMAND = 2,     /* client: photorque_command_packet */
  PHOTORQUE_MEASUREMENT = 3, /* server: photorque_measurement_packet */
  PHOTORQUE_GOODBYE = 4      /* client: leaves, its last command ends; only a header */
};

enum photorque_flag {
  PHOTORQUE_NEW = 1,    /* the readings are new to the client; if unset, only the tick is */
  PHOTORQUE_ANSWER = 2, /* lockstep: the server waits for a command whose `tick` is `now_tick` */
  PHOTORQUE_LATE = 4,   /* sent after the deadline */
  PHOTORQUE_LAST = 8,   /* the run has ended */
  PHOTORQUE_TRUTH = 16  /* true_attitude and true_rate_rad_s are filled in */
};

typedef struct {
  uint32_t magic;
  uint16_t version;
  uint16_t kind;
  uint32_t size;     /* of the whole packet in bytes */
  uint32_t checksum; /* CRC-32 (IEEE 802.3, as in zlib) of the packet with zero here */
  uint64_t sequence; /* of the sender: rises with every packet; older ones are rejected */
  uint64_t sent_ns;
  uint64_t tick; /* measurement: tick of the reading; command: the `now_tick` that it answers */
  uint64_t run;  /* number of this run, set by the server; a client copies it, 0 in a hello */
} photorque_header;

typedef struct {
  photorque_header header;
  double torque_body_N_m[3]; /* acts from the tick of its arrival until the next command arrives */
} photorque_command_packet;

typedef struct {
  photorque_header header;
  uint64_t now_tick;          /* tick of arrival; equals header.tick unless a link delays it */
  uint64_t command_sequence;  /* of the acting command; 0: none yet */
  uint64_t command_sent_ns;   /* its sent_ns, for the round-trip time */
  double t_s;                 /* of header.tick */
  double attitude[4];         /* of the camera; NaN in ticks without a reading */
  double gyro_rad_s[3];       /* body axes; NaN in ticks without a reading */
  double yaw_rad;             /* azimuth of body x from the encoder; NaN without encoder */
  double battery_current_A;   /* until this tick */
  double array_power_W;       /* until this tick */
  double command_body_N_m[3]; /* torque applied until this tick */
  double true_attitude[4];    /* zero without PHOTORQUE_TRUTH */
  double true_rate_rad_s[3];  /* body axes */
  double step_s;              /* from tick to tick */
  uint32_t flags;             /* enum photorque_flag */
  uint32_t refused;           /* number of rejected packets so far, of all senders */
} photorque_measurement_packet;

/* NOLINTEND(modernize-use-using) */

/* CRC-32 of a packet, with its own field counted as zero. */
static inline uint32_t photorque_checksum(const void* packet, uint32_t size) {
  const unsigned char* bytes = (const unsigned char*)packet;
  const size_t own = offsetof(photorque_header, checksum);
  uint32_t crc = 0xffffffffu;
  for (uint32_t i = 0; i < size; ++i) {
    crc ^= i >= own && i < own + 4 ? 0u : bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

/* Fills in the common fields of every packet, and finally the checksum. */
static inline void photorque_seal(photorque_header* header, uint16_t kind, uint32_t size) {
  header->magic = PHOTORQUE_MAGIC;
  header->version = (uint16_t)PHOTORQUE_VERSION;
  header->kind = kind;
  header->size = size;
  header->checksum = photorque_checksum(header, size);
}

#endif
