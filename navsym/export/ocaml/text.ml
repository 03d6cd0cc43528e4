(* Transport: one JSON value, read with limits, and the small readers that the rest of the checker uses.
   Section 1 of docs/certificates.md. *)

exception Refused of string (* something is not as the page says *)
exception Outside of string (* something this program does not implement *)

let refuse format = Printf.ksprintf (fun s -> raise (Refused s)) format
let outside format = Printf.ksprintf (fun s -> raise (Outside s)) format

type json = Null | Bool of bool | Int of Z.t | Text of string | List of json list | Object of (string * json) list

let deepest = 1000 (* levels of lists and objects *)
let largest = 50_000_000 (* bytes of one document *)
let most_digits = 4000

let is_digit c = c >= '0' && c <= '9'
let is_letter c = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')

(* Reader. [s] is the text, [at] the next place. *)

(* The length of the well-formed character (RFC 3629) that begins at place i; 0 when there is none. *)
let character_length s i =
  let byte k = if i + k < String.length s then Char.code s.[i + k] else 0 in
  let follows k = byte k land 0xC0 = 0x80 in
  let b = byte 0 and c = byte 1 in
  if b < 0x80 then 1
  else if b >= 0xC2 && b < 0xE0 && follows 1 then 2
  else if b land 0xF0 = 0xE0 && follows 1 && follows 2 && (b <> 0xE0 || c >= 0xA0) && (b <> 0xED || c < 0xA0) then 3
  else if b >= 0xF0 && b < 0xF5 && follows 1 && follows 2 && follows 3 && (b <> 0xF0 || c >= 0x90) && (b <> 0xF4 || c < 0x90)
  then 4
  else 0

let check_utf8 s =
  let rec go i =
    if i < String.length s then
      match character_length s i with 0 -> refuse "text is not UTF-8 at byte %d" i | n -> go (i + n)
  in
  go 0

type source = { s : string; mutable at : int }

let peek r = if r.at < String.length r.s then r.s.[r.at] else '\000'
let fail r what = refuse "no JSON: expected %s at byte %d" what r.at

let rec skip r =
  match peek r with
  | ' ' | '\t' | '\n' | '\r' when r.at < String.length r.s -> r.at <- r.at + 1; skip r
  | _ -> ()

let expect r c = if peek r = c && r.at < String.length r.s then r.at <- r.at + 1 else fail r (Printf.sprintf "'%c'" c)

let read_hex r =
  if r.at + 4 > String.length r.s then fail r "four hexadecimal digits";
  let value c =
    match c with
    | '0' .. '9' -> Char.code c - 48
    | 'a' .. 'f' -> Char.code c - 87
    | 'A' .. 'F' -> Char.code c - 55
    | _ -> fail r "a hexadecimal digit"
  in
  let v = ref 0 in
  for i = r.at to r.at + 3 do v := (!v * 16) + value r.s.[i] done;
  r.at <- r.at + 4;
  !v

(* What stands behind \u: a character, or the two halves of one. A lone half is refused. *)
let read_unicode r =
  let first = read_hex r in
  if first < 0xD800 || first > 0xDFFF then first
  else begin
    if first > 0xDBFF then fail r "a first half of a character";
    expect r '\\'; expect r 'u';
    let second = read_hex r in
    if second < 0xDC00 || second > 0xDFFF then fail r "a second half of a character";
    0x10000 + ((first - 0xD800) * 1024) + (second - 0xDC00)
  end

let read_text r =
  expect r '"';
  let out = Buffer.create 32 in
  let escape () =
    let c = peek r in
    r.at <- r.at + 1;
    match c with
    | '"' | '\\' | '/' -> Buffer.add_char out c
    | 'b' -> Buffer.add_char out '\b'
    | 'f' -> Buffer.add_char out '\012'
    | 'n' -> Buffer.add_char out '\n'
    | 'r' -> Buffer.add_char out '\r'
    | 't' -> Buffer.add_char out '\t'
    | 'u' -> Buffer.add_utf_8_uchar out (Uchar.of_int (read_unicode r))
    | _ -> fail r "an escaped character"
  in
  let rec go () =
    if r.at >= String.length r.s then fail r "the end of a string";
    let c = peek r in
    r.at <- r.at + 1;
    if c = '"' then Buffer.contents out
    else begin
      if c = '\\' then escape () else if c < ' ' then fail r "no control character" else Buffer.add_char out c;
      go ()
    end
  in
  go ()

let read_integer r =
  let from = r.at in
  if peek r = '-' then r.at <- r.at + 1;
  let first = r.at in
  while is_digit (peek r) do r.at <- r.at + 1 done;
  let digits = r.at - first in
  if digits = 0 then fail r "a digit";
  if digits > 1 && r.s.[first] = '0' then fail r "no leading zero";
  if digits > most_digits then refuse "an integer of %d digits" digits;
  (match peek r with '.' | 'e' | 'E' -> refuse "a number with a fraction or an exponent" | _ -> ());
  Int (Z.of_string (String.sub r.s from (r.at - from)))

let read_word r word value =
  let n = String.length word in
  if r.at + n <= String.length r.s && String.sub r.s r.at n = word then (r.at <- r.at + n; value) else fail r "a JSON value"

let rec read_value depth r =
  if depth > deepest then refuse "deeper than %d levels" deepest;
  skip r;
  match peek r with
  | '{' -> r.at <- r.at + 1; skip r; read_object depth r
  | '[' -> r.at <- r.at + 1; skip r; read_list depth r
  | '"' -> Text (read_text r)
  | 't' -> read_word r "true" (Bool true)
  | 'f' -> read_word r "false" (Bool false)
  | 'n' -> read_word r "null" Null
  | '-' | '0' .. '9' -> read_integer r
  | _ -> fail r "a JSON value"

and read_object depth r =
  let seen = Hashtbl.create 8 in
  let rec go done_ =
    skip r;
    let key = read_text r in
    if Hashtbl.mem seen key then refuse "the key %S is given twice" key;
    Hashtbl.add seen key ();
    skip r; expect r ':';
    let value = read_value (depth + 1) r in
    skip r;
    let done_ = (key, value) :: done_ in
    if peek r = ',' then (r.at <- r.at + 1; go done_) else (expect r '}'; Object (List.rev done_))
  in
  if peek r = '}' then (r.at <- r.at + 1; Object []) else go []

and read_list depth r =
  let rec go done_ =
    let done_ = read_value (depth + 1) r :: done_ in
    skip r;
    if peek r = ',' then (r.at <- r.at + 1; go done_) else (expect r ']'; List (List.rev done_))
  in
  if peek r = ']' then (r.at <- r.at + 1; List []) else go []

let read_document s =
  if String.length s > largest then refuse "more than %d bytes" largest;
  check_utf8 s;
  let r = { s; at = 0 } in
  let value = read_value 0 r in
  skip r;
  if r.at < String.length s then fail r "the end of the document";
  value

(* Parts of a document *)

let get_object what = function Object o -> o | _ -> refuse "%s: expected an object" what
let get_list what = function List l -> l | _ -> refuse "%s: expected a list" what
let get_text what = function Text s -> s | _ -> refuse "%s: expected a string" what

let get_integer what low high = function
  | Int z when Z.leq (Z.of_int low) z && Z.leq z (Z.of_int high) -> Z.to_int z
  | _ -> refuse "%s: expected an integer from %d to %d" what low high

(* The values of exactly these keys, in this order. *)
let get_keys what names value =
  let o = get_object what value in
  if List.length o <> List.length names || not (List.for_all (fun n -> List.mem_assoc n o) names) then
    refuse "%s: expected exactly the keys %s" what (String.concat ", " names);
  List.map (fun n -> List.assoc n o) names

let is_name s =
  s <> "" && s <> "pi" && is_letter s.[0] && String.for_all (fun c -> is_letter c || is_digit c || c = '_') s

let get_name what value =
  let s = get_text what value in
  if is_name s then s else refuse "%s: expected a name" what

let power_of_ten n = Z.pow (Z.of_int 10) n

let decimal whole fraction =
  Q.make (Z.of_string (whole ^ fraction)) (power_of_ten (String.length fraction))

let get_number what value =
  let s = get_text what value in
  let bad () = refuse "%s: expected a number as a string" what in
  let is_digits d = d <> "" && String.length d <= most_digits && String.for_all is_digit d in
  let sign, rest =
    if s <> "" && s.[0] = '-' then (Q.minus_one, String.sub s 1 (String.length s - 1)) else (Q.one, s)
  in
  let parts c = String.split_on_char c rest in
  let size =
    match (parts '.', parts '/') with
    | [ d ], [ _ ] when is_digits d -> Q.of_bigint (Z.of_string d)
    | [ a; b ], [ _ ] when is_digits a && is_digits b -> decimal a b
    | [ _ ], [ a; b ] when is_digits a && is_digits b ->
        let below = Z.of_string b in
        if Z.sign below = 0 then refuse "%s: a denominator 0" what;
        Q.make (Z.of_string a) below
    | _ -> bad ()
  in
  Q.mul sign size
