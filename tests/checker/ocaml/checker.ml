(* A second checker of navsym's certificates, written from docs/certificates.md alone.

   checker FILE   one certificate; exit code 0 accepted, 1 refused, 2 outside
   checker        lines `id TAB certificate` from standard input; a line `id TAB answer` for each

   The answers are `accepted`, `refused: why` and `outside: what`. What the page does not specify, or what is not implemented here, is
   outside; it is never accepted. *)

open Text
open Tree
open Ball
open Value
open Rules

(* Statements *)

type statement = { goals : (tree * relation) list; box : (string * range) list; said : tree list }

let get_side what = function Text s -> read_tree s | List _ | Object _ -> outside "matrices and cases" | _ -> refuse "%s: expected an expression" what

let read_goals left right relation tolerance =
  let d = subtract left right in
  match (relation, tolerance) with
  | "=", None -> [ (d, Equal) ]
  | "=", Some e -> [ (Sum [ e; d ], AtLeast); (Sum [ e; negate d ], AtLeast) ]
  | _, Some _ -> refuse "a tolerance goes with = only"
  | "!=", None -> [ (d, Unequal) ]
  | ">", None -> [ (d, Above) ]
  | ">=", None -> [ (d, AtLeast) ]
  | "<", None -> [ (subtract right left, Above) ]
  | "<=", None -> [ (subtract right left, AtLeast) ]
  | _ -> refuse "unknown relation %S" relation

let read_statement value =
  let o = get_object "statement" value in
  let beyond = List.filter (fun k -> List.mem_assoc k o) [ "shapes"; "given"; "rates"; "order" ] in
  if beyond <> [] then outside "statement with %s" (String.concat ", " beyond);
  match get_keys "statement" [ "left"; "right"; "relation"; "symbols"; "exists"; "tolerance" ] value with
  | [ left; right; relation; symbols; exists; tolerance ] ->
      let left = get_side "left" left and right = get_side "right" right in
      let tolerance = match tolerance with Null -> None | v -> Some (get_side "tolerance" v) in
      let exists = List.map (get_side "exists") (get_list "exists" exists) in
      let read (name, v) = if is_name name then (name, read_range name v) else refuse "expected a name" in
      let box = List.map read (get_object "symbols" symbols) in
      let said = (left :: right :: Option.to_list tolerance) @ exists in
      let goals = read_goals left right (get_text "relation" relation) tolerance in
      { goals; box; said }
  | _ -> assert false

let goal_of s (tree, relation) = { tree; relation; box = s.box; exists = s.said; given = []; zeros = [] }

(* All that the statement says has a finite ball at a point in the box. *)
let check_values s point =
  check_point s.box point;
  let balls = List.map (fun (name, t) -> (name, number_ball name t)) point in
  let value name = match List.assoc_opt name balls with Some x -> x | None -> no_symbols name in
  List.iter (fun t -> if finite_ball value t = None then refuse "no value at the point") s.said;
  value

(* Kinds *)

let keep_out_answers value = if List.mem_assoc "answers" (get_object "certificate" value) then outside "answers"

let check_identity value =
  match get_keys "identity" [ "kind"; "left"; "right"; "symbols" ] value with
  | [ _; left; right; symbols ] ->
      let names = List.map (get_name "symbols") (get_list "symbols" symbols) in
      if List.length (List.sort_uniq compare names) <> List.length names then refuse "a name given twice";
      let difference = subtract (get_tree "left" left) (get_tree "right" right) in
      Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (Tree.symbols difference);
      shown "the sides differ" (Algebra.normal_form_vanishes difference)
  | _ -> assert false

let check_positivity value =
  match get_keys "positivity" [ "kind"; "expression"; "box"; "bits"; "cells" ] value with
  | [ _; expression; box; bits; cells ] ->
      let t = get_tree "expression" expression and bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () ->
          let read (name, v) =
            match get_list name v with
            | [ low; high ] when is_name name ->
                let low = number_ball name (get_tree name low) in
                (name, { low; length = less (number_ball name (get_tree name high)) low; start = Z.zero; level = 0 })
            | _ -> refuse "box: expected [from, to] by name"
          in
          let sides = List.map read (get_object "box" box) in
          Names.iter (fun s -> if not (List.mem_assoc s sides) then no_symbols s) (Tree.symbols t);
          let settled cell =
            let balls = Map_of_names.map part_ball cell in
            match ball Whole (find balls) t with x -> is_above x | exception No_value -> false
          in
          let box = List.fold_left (fun m (n, s) -> Map_of_names.add n s m) Map_of_names.empty sides in
          bisect ~cells:(cells_allowed cells) ~names:(List.map fst sides) ~settled box)
  | _ -> assert false

let check_proof value =
  keep_out_answers value;
  match get_keys "proof" [ "kind"; "statement"; "bits"; "witness"; "proofs" ] value with
  | [ _; statement; bits; witness; proofs ] ->
      at_precision (get_bits 20000 bits) (fun () ->
          let s = read_statement statement in
          let (_ : string -> ball) = check_values s (read_numbers "witness" witness) in
          prove_each "proofs" (List.map (goal_of s) s.goals) (get_list "proofs" proofs))
  | _ -> assert false

let fails value (t, relation) =
  match finite_ball value t with
  | None -> false
  | Some x -> (
      match relation with
      | Equal -> not (has_zero x)
      | Unequal -> is_exactly_zero x
      | Above -> sign_of x.hi <= 0
      | AtLeast -> is_below x)

let check_counterexample value =
  keep_out_answers value;
  match get_keys "counterexample" [ "kind"; "statement"; "bits"; "point"; "zero" ] value with
  | [ _; statement; bits; point; zero ] ->
      at_precision (get_bits 200000 bits) (fun () ->
          let s = read_statement statement in
          let point = read_numbers "point" point in
          let value = check_values s point in
          match (zero, s.goals) with
          | Null, goals -> shown "the statement is not seen to fail" (List.exists (fails value) goals)
          | proof, [ (t, (Above | Unequal)) ] -> prove (alone (put point t) Equal) proof
          | _ -> refuse "the relation allows 0")
  | _ -> assert false

let rec check value =
  match List.assoc_opt "kind" (get_object "certificate" value) with
  | None -> refuse "expected the key kind"
  | Some kind -> (
      match get_text "kind" kind with
      | "identity" -> check_identity value
      | "positivity" -> check_positivity value
      | "proof" -> check_proof value
      | "counterexample" -> check_counterexample value
      | "all" -> (
          match get_keys "all" [ "kind"; "of" ] value with
          | [ _; List (_ :: _ as l) ] -> List.iter check l
          | _ -> refuse "of: expected a list of at least one certificate")
      | name -> outside "kind %s" name)

(* Answers *)

type answer = Accepted | Refusal of string | Not_here of string

let judge text =
  Algebra.forget ();
  precision := 96;
  match check (read_document text) with
  | () -> Accepted
  | exception Refused why -> Refusal why
  | exception Outside what -> Not_here what
  | exception Stack_overflow -> Refusal "too deep"
  | exception Out_of_memory -> Refusal "too large"
  | exception No_value -> Refusal "no value"
  | exception Nowhere -> Refusal "no value"
  | exception Z.Overflow -> Refusal "a number too large"
  | exception Division_by_zero -> Refusal "a division by 0"

let printed = function Accepted -> "accepted" | Refusal why -> "refused: " ^ why | Not_here what -> "outside: " ^ what

let judge_lines () =
  try
    while true do
      let line = input_line stdin in
      match String.index_opt line '\t' with
      | None -> Printf.printf "?\trefused: expected an id, a tab and a certificate\n%!"
      | Some i ->
          let text = String.sub line (i + 1) (String.length line - i - 1) in
          Printf.printf "%s\t%s\n%!" (String.sub line 0 i) (printed (judge text))
    done
  with End_of_file -> ()

let judge_file path =
  let channel = open_in_bin path in
  let answer = judge (really_input_string channel (in_channel_length channel)) in
  print_endline (printed answer);
  exit (match answer with Accepted -> 0 | Refusal _ -> 1 | Not_here _ -> 2)

let () =
  match Array.to_list Sys.argv with
  | [ _ ] -> judge_lines ()
  | [ _; path ] -> ( try judge_file path with Sys_error why -> prerr_endline why; exit 3)
  | _ -> prerr_endline "usage: checker [FILE]"; exit 3
