#include "nesting.h"

#include <yaml.h>

bool nesting_is_too_deep(const char *text, size_t length, int *line, int *column)
{
    yaml_parser_t parser;
    int depth = 0;
    bool is_end = false;
    if (!yaml_parser_initialize(&parser)) return false; /* the loader says so */
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    while (!is_end && depth <= NESTING_MOST) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) break;
        bool begins =
            event.type == YAML_MAPPING_START_EVENT || event.type == YAML_SEQUENCE_START_EVENT;
        bool ends = event.type == YAML_MAPPING_END_EVENT || event.type == YAML_SEQUENCE_END_EVENT;
        depth += begins - ends;
        is_end = event.type == YAML_STREAM_END_EVENT;
        *line = (int)event.start_mark.line + 1;
        *column = (int)event.start_mark.column + 1;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return depth > NESTING_MOST;
}
